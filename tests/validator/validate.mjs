// Validates glTF and GLB files with the Khronos validator:
//     node validate.mjs FILE...
// Prints one line per file and every error; exits with 1 when there is any error.
import { readFileSync } from "node:fs";
import { basename, dirname, resolve } from "node:path";
import validator from "gltf-validator";

let failed = 0;
const files = process.argv.slice(2);
if (files.length === 0) {
  console.error("usage: node validate.mjs FILE...");
  process.exit(2);
}
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
    uri: basename(file),
    maxIssues: 1000,
    externalResourceFunction: async (uri) =>
      new Uint8Array(readFileSync(resolve(dirname(file), decodeURIComponent(uri)))),
  });
  const { numErrors, numWarnings, numInfos, messages } = report.issues;
  const facts = report.info;
  console.log(
    `${numErrors === 0 ? "Pass" : "Fail"} ${basename(file)}: ${numErrors} errors, ` +
      `${numWarnings} warnings, ${numInfos} hints; ${facts.totalVertexCount} vertices, ` +
      `${facts.totalTriangleCount} triangles, ${facts.materialCount} materials`,
  );
  const seen = new Map();
  for (const m of messages.filter((m) => m.severity <= 1)) {
    const count = (seen.get(m.code) ?? 0) + 1;
    seen.set(m.code, count);
    if (count <= (m.severity === 0 ? 5 : 1)) console.log(`  ${["error", "warning"][m.severity]} ${m.code} ${m.pointer}: ${m.message}`);
  }
  failed += numErrors > 0 ? 1 : 0;
}
process.exit(failed === 0 ? 0 : 1);

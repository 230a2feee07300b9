//! Leaf kernels against their twins.

use umbrage::app::conform;

use crate::fixture;

#[test]
fn leaf_cases_pass() {
    let gpu = fixture::gpu();
    let mut ran = 0;
    for case in conform::cases() {
        if case.name.starts_with("leaf.albedo") || case.name.starts_with("leaf.glossy") {
            let outcome = (case.run)(&gpu).unwrap();
            println!("{}: {} of {}", case.name, outcome.error, outcome.limit);
            assert!(outcome.passed(), "{}: {outcome:?}", case.name);
            ran += 1;
        }
    }
    assert_eq!(ran, 5, "cases of leaf appearance");
}

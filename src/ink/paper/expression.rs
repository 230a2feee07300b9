//! Expressions of style files, made into programs of a stack that kernels run.
//!
//! Numbers, `pi`, variables, `+ - * / % ^`, comparisons (1 or 0), brackets and functions. Crates
//! that evaluate expressions do so on the CPU; here the pixels are the device's, so what is wanted
//! is the program, and where in the text a mistake stands.

use crate::abi::{
    PAPER_ABS, PAPER_ADD, PAPER_CLAMP, PAPER_COS, PAPER_DIV, PAPER_EXP, PAPER_FLOOR, PAPER_FRACT,
    PAPER_GREATER, PAPER_IF, PAPER_LESS, PAPER_LOG, PAPER_MAX, PAPER_MIN, PAPER_MIX, PAPER_MOD,
    PAPER_MUL, PAPER_NEG, PAPER_NOT, PAPER_NUMBER, PAPER_OPS, PAPER_POW, PAPER_SIN, PAPER_SMOOTH,
    PAPER_SQRT, PAPER_STACK, PAPER_SUB, PAPER_VARIABLE, PaperOp,
};

/// Variables, in the order of their numbers.
///
/// Place in the picture (`x` to the right, `y` upwards, 0 to 1), depth in the paper's unit,
/// number of the primitive (0 for stems), number of the object that the leaf belongs to, shadow
/// (0 to 1), light from the sun and around (0 to 1), unit normal in the camera's frame (x right,
/// y up, z to the viewer), the painted mask (0 black to 1 white).
pub const VARIABLES: [&str; 11] = [
    "x", "y", "z", "id", "object", "shadow", "tone", "nx", "ny", "nz", "mask",
];

/// Functions: name, number of arguments, code.
const FUNCTIONS: [(&str, usize, u32); 14] = [
    ("abs", 1, PAPER_ABS),
    ("sqrt", 1, PAPER_SQRT),
    ("sin", 1, PAPER_SIN),
    ("cos", 1, PAPER_COS),
    ("exp", 1, PAPER_EXP),
    ("log", 1, PAPER_LOG),
    ("floor", 1, PAPER_FLOOR),
    ("fract", 1, PAPER_FRACT),
    ("min", 2, PAPER_MIN),
    ("max", 2, PAPER_MAX),
    ("clamp", 3, PAPER_CLAMP),
    ("mix", 3, PAPER_MIX),
    ("smooth", 3, PAPER_SMOOTH),
    ("if", 3, PAPER_IF),
];

/// Brackets and signs within each other at most.
const DEEPEST: usize = 32;

/// A program whose value is what an expression says.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Program {
    /// Steps: each takes its arguments from the stack and leaves one value.
    pub ops: Vec<PaperOp>,
}

impl Program {
    /// Of an expression; what is wrong begins with the column (from 1).
    ///
    /// # Errors
    /// Text that is no expression, unknown names, wrong numbers of arguments, more than
    /// [`PAPER_OPS`] steps or [`PAPER_STACK`] values at a time.
    pub fn new(text: &str) -> Result<Self, String> {
        let mut parser = Parser {
            text: text.chars().collect(),
            at: 0,
            ops: Vec::new(),
            nested: 0,
        };
        parser.comparison()?;
        parser.blanks();
        if parser.at < parser.text.len() {
            let found = parser.text[parser.at];
            return Err(parser.wrong(&format!("expected the end or an operator, not `{found}`")));
        }
        let ops = parser.ops;
        if ops.len() > PAPER_OPS as usize {
            return Err(format!("{} steps: at most {PAPER_OPS}", ops.len()));
        }
        let program = Self { ops };
        let deepest = program.deepest();
        if deepest > PAPER_STACK as usize {
            return Err(format!(
                "{deepest} values at a time: at most {PAPER_STACK}; nest less"
            ));
        }
        Ok(program)
    }

    /// Whether a variable of [`VARIABLES`] is read.
    #[must_use]
    pub fn reads(&self, variable: &str) -> bool {
        let number = VARIABLES.iter().position(|v| *v == variable);
        let reads = |op: &PaperOp| {
            number.is_some_and(|n| op.code == PAPER_VARIABLE && op.value == n as f32)
        };
        self.ops.iter().any(reads)
    }

    /// Values on the stack at most.
    fn deepest(&self) -> usize {
        let (mut now, mut most) = (0, 0);
        for op in &self.ops {
            now = now + 1 - arguments(op.code);
            most = most.max(now);
        }
        most
    }
}

/// Values that a step takes.
pub(super) fn arguments(code: u32) -> usize {
    match code {
        PAPER_NUMBER | PAPER_VARIABLE => 0,
        PAPER_NEG..=PAPER_FRACT => 1,
        PAPER_ADD..=PAPER_GREATER => 2,
        _ => 3,
    }
}

struct Parser {
    text: Vec<char>,
    at: usize,
    ops: Vec<PaperOp>,
    nested: usize,
}

impl Parser {
    fn wrong(&self, why: &str) -> String {
        format!("column {}: {why}", self.at + 1)
    }

    fn blanks(&mut self) {
        while self.text.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
    }

    /// The next sign that is no blank.
    fn next(&mut self) -> Option<char> {
        self.blanks();
        self.text.get(self.at).copied()
    }

    fn takes(&mut self, sign: char) -> bool {
        let found = self.next() == Some(sign);
        self.at += usize::from(found);
        found
    }

    fn push(&mut self, code: u32, value: f32) {
        self.ops.push(PaperOp { code, value });
    }

    fn comparison(&mut self) -> Result<(), String> {
        self.nested += 1;
        if self.nested > DEEPEST {
            return Err(self.wrong(&format!("more than {DEEPEST} brackets within each other")));
        }
        self.sum()?;
        while let Some(sign @ ('<' | '>')) = self.next() {
            self.at += 1;
            let or_equal = self.text.get(self.at) == Some(&'=');
            self.at += usize::from(or_equal);
            self.sum()?;
            // `a <= b` is that not `a > b`.
            let less = (sign == '<') != or_equal;
            self.push(if less { PAPER_LESS } else { PAPER_GREATER }, 0.0);
            if or_equal {
                self.push(PAPER_NOT, 0.0);
            }
        }
        self.nested -= 1;
        Ok(())
    }

    fn sum(&mut self) -> Result<(), String> {
        self.product()?;
        while let Some(sign @ ('+' | '-')) = self.next() {
            self.at += 1;
            self.product()?;
            self.push(if sign == '+' { PAPER_ADD } else { PAPER_SUB }, 0.0);
        }
        Ok(())
    }

    fn product(&mut self) -> Result<(), String> {
        self.signed()?;
        while let Some(sign @ ('*' | '/' | '%')) = self.next() {
            self.at += 1;
            self.signed()?;
            let code = match sign {
                '*' => PAPER_MUL,
                '/' => PAPER_DIV,
                _ => PAPER_MOD,
            };
            self.push(code, 0.0);
        }
        Ok(())
    }

    /// `-a ^ b` is `-(a ^ b)`, and `a ^ -b` may be written.
    fn signed(&mut self) -> Result<(), String> {
        let mut signs = 0;
        while let Some(sign @ ('+' | '-')) = self.next() {
            self.at += 1;
            signs += usize::from(sign == '-');
        }
        self.value()?;
        if self.takes('^') {
            self.nested += 1;
            if self.nested > DEEPEST {
                return Err(self.wrong(&format!("more than {DEEPEST} powers of powers")));
            }
            self.signed()?;
            self.nested -= 1;
            self.push(PAPER_POW, 0.0);
        }
        if signs % 2 == 1 {
            self.push(PAPER_NEG, 0.0);
        }
        Ok(())
    }

    fn value(&mut self) -> Result<(), String> {
        match self.next() {
            Some('(') => {
                self.at += 1;
                self.comparison()?;
                self.closes()
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.named(),
            Some(c) => Err(self.wrong(&format!("expected a value, not `{c}`"))),
            None => Err(self.wrong("expected a value, not the end")),
        }
    }

    fn closes(&mut self) -> Result<(), String> {
        if self.takes(')') {
            Ok(())
        } else {
            Err(self.wrong("expected `)`"))
        }
    }

    fn number(&mut self) -> Result<(), String> {
        let start = self.at;
        let mut exponent = false;
        while let Some(&c) = self.text.get(self.at) {
            let sign = exponent && matches!(c, '+' | '-');
            exponent = matches!(c, 'e' | 'E');
            if !(c.is_ascii_digit() || c == '.' || exponent || sign) {
                break;
            }
            self.at += 1;
        }
        let text: String = self.text[start..self.at].iter().collect();
        let value = text.parse::<f32>().ok().filter(|v| v.is_finite());
        let Some(value) = value else {
            self.at = start;
            return Err(self.wrong(&format!("`{text}` is no number")));
        };
        self.push(PAPER_NUMBER, value);
        Ok(())
    }

    fn named(&mut self) -> Result<(), String> {
        let start = self.at;
        let in_name = |c: &char| c.is_alphanumeric() || *c == '_';
        while self.text.get(self.at).is_some_and(in_name) {
            self.at += 1;
        }
        let name: String = self.text[start..self.at].iter().collect();
        if self.takes('(') {
            let Some(&(_, wanted, code)) = FUNCTIONS.iter().find(|f| f.0 == name) else {
                self.at = start;
                let known = FUNCTIONS.map(|f| f.0).join(", ");
                return Err(self.wrong(&format!("`{name}` is no function; there are {known}")));
            };
            let mut found = 1;
            self.comparison()?;
            while self.takes(',') {
                self.comparison()?;
                found += 1;
            }
            self.closes()?;
            if found != wanted {
                self.at = start;
                return Err(self.wrong(&format!("`{name}` takes {wanted} values, not {found}")));
            }
            self.push(code, 0.0);
            return Ok(());
        }
        if name == "pi" {
            self.push(PAPER_NUMBER, std::f32::consts::PI);
            return Ok(());
        }
        let Some(number) = VARIABLES.iter().position(|v| *v == name) else {
            self.at = start;
            let known = VARIABLES.join(", ");
            return Err(self.wrong(&format!(
                "`{name}` is no variable; there are {known} and pi"
            )));
        };
        self.push(PAPER_VARIABLE, number as f32);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_are_told_with_their_column() {
        for (text, said) in [
            ("", "column 1: expected a value, not the end"),
            ("1 + ", "column 5: expected a value"),
            ("1 + * 2", "column 5: expected a value, not `*`"),
            ("(x + 1", "column 7: expected `)`"),
            ("x y", "column 3: expected the end or an operator, not `y`"),
            (
                "2 * depht",
                "column 5: `depht` is no variable; there are x, y",
            ),
            ("x + sine(y)", "column 5: `sine` is no function"),
            ("min(x)", "column 1: `min` takes 2 values, not 1"),
            ("1.2.3", "column 1: `1.2.3` is no number"),
            ("1e99", "column 1: `1e99` is no number"),
            ("x)", "column 2"),
            ("min()", "column 5"),
            ("x = 1", "column 3"),
            ("ä", "column 1: `ä` is no variable"),
        ] {
            let error = Program::new(text).unwrap_err();
            assert!(error.contains(said), "{text}: {error}");
        }
        let deep = "(".repeat(40_000);
        assert!(Program::new(&deep).unwrap_err().contains("brackets"));
        let deep = "2^".repeat(40_000);
        assert!(Program::new(&deep).unwrap_err().contains("powers"));
        let long = "1+".repeat(40) + "1";
        assert!(Program::new(&long).unwrap_err().contains("steps"));
        let wide = "1+(".repeat(17) + "1" + &")".repeat(17);
        assert!(Program::new(&wide).unwrap_err().contains("at a time"));
    }

    #[test]
    fn programs_know_what_they_read() {
        let program = Program::new("if(mask > 0.5, 1, z)").unwrap();
        assert!(program.reads("mask") && program.reads("z"));
        assert!(!program.reads("x") && !program.reads("shadow"));
        assert_eq!(program.deepest(), 3);
    }
}

//! Papers by their names.

/// Width and height, millimetres, of a paper by its name (upright), or `WIDTHxHEIGHT`.
///
/// # Errors
/// The names that there are.
pub fn paper_size(text: &str) -> Result<[f64; 2], String> {
    let named = match text.to_ascii_lowercase().as_str() {
        "a6" => Some([105.0, 148.0]),
        "a5" => Some([148.0, 210.0]),
        "a4" => Some([210.0, 297.0]),
        "a3" => Some([297.0, 420.0]),
        "a2" => Some([420.0, 594.0]),
        "a1" => Some([594.0, 841.0]),
        "a0" => Some([841.0, 1189.0]),
        "letter" => Some([215.9, 279.4]),
        "tabloid" => Some([279.4, 431.8]),
        _ => None,
    };
    let turned = text
        .strip_suffix("-landscape")
        .and_then(|upright| paper_size(upright).ok())
        .map(|[w, h]| [h, w]);
    let given = || {
        let (w, h) = text.split_once('x')?;
        let size = [w.trim().parse::<f64>().ok()?, h.trim().parse::<f64>().ok()?];
        size.iter()
            .all(|s| (10.0..=5000.0).contains(s))
            .then_some(size)
    };
    named.or(turned).or_else(given).ok_or_else(|| {
        "expected a6 to a0, letter, tabloid (with -landscape: turned) or WIDTHxHEIGHT in millimetres, 10 to 5000".into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn papers_have_their_names_and_any_size() {
        assert_eq!(paper_size("A4"), Ok([210.0, 297.0]));
        assert_eq!(paper_size("a3-landscape"), Ok([420.0, 297.0]));
        assert_eq!(paper_size("100x80.5"), Ok([100.0, 80.5]));
        for wrong in ["a9", "0x5", "nanx20", "", "-landscape"] {
            assert!(paper_size(wrong).unwrap_err().contains("letter"), "{wrong}");
        }
    }
}

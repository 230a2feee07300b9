//! Bytes as runs of equal ones: (value, length 1 to 255) pairs, as in Wang et al. 2005.

/// The runs of `bytes`.
#[must_use]
pub fn encode(bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut rest = bytes;
    while let Some(&value) = rest.first() {
        let run = rest.iter().take(255).take_while(|&&b| b == value).count();
        out.extend([value, run as u8]);
        rest = &rest[run..];
    }
    out
}

/// The `count` bytes of some runs; nothing when the runs say otherwise.
#[must_use]
pub fn decode(runs: &[u8], count: usize) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(count);
    let pairs = runs.chunks_exact(2);
    if !pairs.remainder().is_empty() {
        return None;
    }
    for pair in pairs {
        let end = out.len() + usize::from(pair[1]);
        if pair[1] == 0 || end > count {
            return None;
        }
        out.resize(end, pair[0]);
    }
    (out.len() == count).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sampling::pcg;

    #[test]
    fn runs_come_back_exactly() {
        let random: Vec<u8> = (0..1000).map(|i| (pcg(i) % 3 * 100) as u8).collect();
        for bytes in [
            vec![],
            vec![0],
            vec![0; 255],
            vec![7; 256],
            vec![0; 5000],
            random,
        ] {
            let runs = encode(&bytes);
            assert_eq!(decode(&runs, bytes.len()).unwrap(), bytes);
            assert!(decode(&runs, bytes.len() + 1).is_none(), "too few");
            if bytes.len() > 1 {
                assert!(decode(&runs, bytes.len() - 1).is_none(), "too many");
            }
        }
        assert!(decode(&[1], 1).is_none() && decode(&[1, 0], 0).is_none());
        assert_eq!(encode(&[9; 300]), [9, 255, 9, 45]);
    }
}

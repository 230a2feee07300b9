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
    let pairs = runs.chunks_exact(2);
    // What the runs say is compared before anything of that size is made.
    let lengths = pairs.clone().map(|pair| usize::from(pair[1]));
    let whole = pairs.remainder().is_empty() && pairs.clone().all(|pair| pair[1] > 0);
    if !whole || lengths.sum::<usize>() != count {
        return None;
    }
    let mut out = Vec::with_capacity(count);
    for pair in pairs {
        out.resize(out.len() + usize::from(pair[1]), pair[0]);
    }
    Some(out)
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
        assert!(decode(&[1, 9], usize::MAX).is_none(), "nothing is reserved");
        assert_eq!(encode(&[9; 300]), [9, 255, 9, 45]);
    }
}

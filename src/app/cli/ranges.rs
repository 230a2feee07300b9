//! Numbers of the command line that have a range: what is outside is refused by the option's own
//! name, before anything is read.

use super::light::Triple;

/// A finite number from `low` to `high`.
pub(super) fn real(
    low: f64,
    high: f64,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| within(number(text)?, low, high)
}

/// [`real`] as f32.
pub(super) fn real32(
    low: f32,
    high: f32,
) -> impl Fn(&str) -> Result<f32, String> + Clone + Send + Sync + 'static {
    move |text| within(number(text)?, low.into(), high.into()).map(|v| v as f32)
}

/// One number for all channels or three, each from `low` to `high`.
pub(super) fn channels(
    low: f64,
    high: f64,
) -> impl Fn(&str) -> Result<Triple, String> + Clone + Send + Sync + 'static {
    move |text| {
        let triple: Triple = text.parse()?;
        for v in triple.0 {
            within(v, low, high)?;
        }
        Ok(triple)
    }
}

fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| "is not a number".into())
}

fn within(value: f64, low: f64, high: f64) -> Result<f64, String> {
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(format!("{value} is not in {low}..={high}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_belong_and_nothing_beyond() {
        let parse = real(0.5, 2.0);
        assert_eq!(parse("0.5"), Ok(0.5));
        assert_eq!(parse(" 2 "), Ok(2.0));
        for bad in ["0.49", "2.01", "nan", "inf", "-inf", "-1", "", "x"] {
            assert!(parse(bad).is_err(), "{bad}");
            assert!(real32(0.5, 2.0)(bad).is_err(), "{bad}");
        }
        let parse = channels(0.0, 1.0);
        assert_eq!(parse("0.5").unwrap().0, [0.5; 3]);
        for bad in ["0,0", "0,0,1.5", "nan", "0,-1,0", "0,,0"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}

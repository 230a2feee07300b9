//! Ranges of the numbers of styles on paper.

use super::inks;
use super::limbs;
use super::modulation::Programs;
use super::polygon::views;
use super::style::PaperStyle;

/// A number of a style: its key, its value, the least and the most that it may be.
pub type Ranged = (String, f64, f64, f64);

impl PaperStyle {
    /// Every number of the style that has a range.
    #[must_use]
    pub fn numbers(&self) -> Vec<Ranged> {
        let h = &self.shadow;
        let (p, d, f, s, sheet) = (
            &self.primitive,
            &self.depth,
            &self.foliage,
            &self.stem,
            &self.sheet,
        );
        let mut numbers = vec![
            ("primitive.size".to_owned(), p.size, 0.001, 10.0),
            ("primitive.aspect".into(), p.aspect, 0.05, 1.0),
            ("primitive.deformation".into(), p.deformation, 0.0, 0.5),
            ("primitive.views".into(), p.views, 0.0, 1.0),
            ("primitive.constant_size".into(), p.constant_size, 0.0, 4.0),
            ("primitive.largest".into(), p.largest, 1.0, 100.0),
            ("depth.near".into(), d.near, 1e-6, 1e9),
            ("depth.far".into(), d.far, d.near * (1.0 + 1e-6), 1e12),
            ("foliage.threshold".into(), f.threshold, 0.0, 65535.0),
            ("stem.order".into(), f64::from(s.order), 0.0, 255.0),
            ("stem.thinnest".into(), s.thinnest, 0.0, 1.0),
            ("stem.threshold".into(), s.threshold, 0.0, 65535.0),
            ("stem.slope".into(), s.slope, 0.0, 10.0),
            ("stem.hatching".into(), s.hatching, 0.0, 1.0),
            ("stem.white".into(), s.white, 0.0, 1.0),
            ("stem.crossing".into(), s.crossing, 0.0, 1.0),
            ("stem.stroke".into(), s.stroke, 0.2, 50.0),
            ("shadow.bias".into(), h.bias, 0.0, 10.0),
            ("shadow.softness".into(), h.softness, 0.001, 10.0),
            ("shadow.reach".into(), f64::from(h.reach), 0.0, 8.0),
            ("shadow.black".into(), h.black, 0.0, 1.0),
            ("shadow.detail".into(), h.detail, -1.0, 1.0),
            ("shadow.pressure".into(), h.pressure, 0.0, 10.0),
            ("shadow.hatching".into(), h.hatching, 0.0, 1.0),
            ("shadow.crossing".into(), h.crossing, 0.0, 1.0),
            ("shadow.angle".into(), h.angle, -180.0, 180.0),
            ("shadow.stroke".into(), h.stroke, 0.2, 50.0),
            ("vector.cell".into(), self.vector.cell, 0.0, 1e9),
            ("ground.size".into(), self.ground.size, 0.001, 10.0),
            ("ground.extent".into(), self.ground.extent, 0.1, 20.0),
            ("ground.bias".into(), self.ground.bias, 0.0, 10.0),
            ("ground.softness".into(), self.ground.softness, 0.001, 10.0),
            ("sheet.paper".into(), sheet.paper[0], 10.0, 5000.0),
            ("sheet.paper".into(), sheet.paper[1], 10.0, 5000.0),
            ("sheet.margin".into(), sheet.margin, 0.0, 500.0),
            ("sheet.resolution".into(), sheet.resolution, 1.0, 40.0),
            ("sheet.tolerance".into(), sheet.tolerance, 0.0, 1.0),
        ];
        let pens = [
            ("foliage.pen", &f.pen),
            ("stem.pen", &s.pen),
            ("stem.hatching_pen", &s.hatching_pen),
            ("shadow.pen", &h.pen),
        ];
        for (name, pen) in pens {
            numbers.push((format!("{name}.width"), pen.width, 0.01, 20.0));
            numbers.push((format!("{name}.ends"), pen.ends, 0.0, 1.0));
            numbers.push((format!("{name}.taper"), pen.taper, 0.0, 1000.0));
            numbers.push((format!("{name}.overshoot"), pen.overshoot, 0.0, 20.0));
            numbers.push((format!("{name}.tremor"), pen.tremor, 0.0, 10.0));
            numbers.push((format!("{name}.wavelength"), pen.wavelength, 0.1, 1000.0));
            numbers.push((format!("{name}.lift"), pen.lift, 0.0, 1.0));
        }
        numbers.extend(inks::numbers(self));
        numbers.extend(limbs::numbers(self));
        numbers.extend(self.tiles.numbers());
        for (name, colour) in [("sheet.ink", sheet.ink), ("sheet.colour", sheet.colour)] {
            numbers.extend(colour.map(|v| (name.to_owned(), f64::from(v), 0.0, 1.0)));
        }
        numbers
    }

    /// Whether every number lies in its range.
    ///
    /// # Errors
    /// The first that does not, with its range.
    pub fn check(&self) -> Result<(), String> {
        let depth = &self.depth;
        if depth.far <= depth.near {
            return Err(format!(
                "depth.far = {}: expected more than depth.near, {}",
                depth.far, depth.near
            ));
        }
        for (name, value, low, high) in self.numbers() {
            // Also false for NaN.
            if !(value >= low && value <= high) {
                return Err(format!(
                    "{name} = {value}: expected {} to {}",
                    shown(low),
                    shown(high)
                ));
            }
        }
        let sheet = &self.sheet;
        if 2.0 * sheet.margin > sheet.paper[0].min(sheet.paper[1]) - 5.0 {
            return Err(format!(
                "sheet.margin = {}: leaves less than 5 mm of a paper of {} x {} mm",
                sheet.margin, sheet.paper[0], sheet.paper[1]
            ));
        }
        Programs::new(self)?;
        views(&self.primitive).map(|_| ())
    }
}

/// A limit in at most six digits.
#[must_use]
pub fn shown(limit: f64) -> String {
    if limit.abs() >= 1e6 {
        return format!("{limit:e}");
    }
    // More digits are roundings of others.
    let rounded: f64 = format!("{limit:.5e}").parse().unwrap_or(limit);
    format!("{rounded}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_told_in_few_digits() {
        for (limit, text) in [
            (11.000_010_999_999_999, "11"),
            (1e12, "1e12"),
            (0.001, "0.001"),
            (65535.0, "65535"),
            (-1.0, "-1"),
        ] {
            assert_eq!(shown(limit), text);
        }
        let text = "format_version = 1\nkind = \"paper\"\ndescription = \"x\"\n[depth]\nnear = 11.0\nfar = 1.0";
        let said = PaperStyle::parse(text).unwrap_err();
        assert_eq!(said, "depth.far = 1: expected more than depth.near, 11");
    }
}

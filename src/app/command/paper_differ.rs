//! `umbrage ink differ` for styles on paper: what lines and strokes are found in on two devices, and
//! the drawings themselves.

use std::path::Path;

use super::ink_differ::{other, read, report};
use super::paper_kind::Kind;
use super::render_paper::{Board, subject};
use crate::Result;
use crate::app::cli::ink_strokes::DifferArgs;
use crate::app::differ::{Share, alike};
use crate::app::timing::Timings;
use crate::app::{Context, Report, console};
use crate::ink::paper::renderer::Maps;
use crate::ink::paper::style::PaperStyle;

/// By how much light and shadow differ where that is told.
const APART: f32 = 1e-3;
/// The row that this is about.
const PICTURE: &str = "picture";

/// Draws on both devices and compares.
///
/// # Errors
/// Wrong input or style, a device that is not there or fails.
pub(super) fn run(context: &Context, args: &DifferArgs, style: &PaperStyle) -> Result<Report> {
    let other = other(args)?;
    let gpu = context.gpu()?;
    let mut timings = Timings::default();
    let (prepared, settings) = read(args, &mut timings)?;
    let subject = subject(prepared, (style, &settings), &mut timings)?;
    let factor = args.ink_supersample;
    let _working = console::working("drawing");
    let mut drawings = Vec::new();
    for gpu in [gpu, &other] {
        let kind = Kind::unnamed(Path::new("x.png"), factor, settings.size);
        let board = Board::on(gpu, kind, style.clone(), &subject, &mut timings)?;
        let view = subject.view(&settings, board.size, None);
        let pixels = board.pixels(&view, (factor, None), &mut timings)?;
        drawings.push((board.maps(&view)?, pixels));
    }
    let found = compare(&drawings[0], &drawings[1]);
    Ok(report(args, [gpu, &other], &found, PICTURE))
}

/// What differs, by name, of what.
fn compare((a, pixels): &(Maps, Vec<u8>), (b, others): &(Maps, Vec<u8>)) -> Vec<(String, Share)> {
    let all = a.size[0] * a.size[1];
    let share = |apart: &dyn Fn(usize) -> bool| Share {
        differing: (0..all).filter(|&i| apart(i)).count(),
        of: all,
    };
    let away = |a: f32, b: f32| (a - b).abs() > APART;
    let mut found = vec![
        (
            "other primitive".to_owned(),
            share(&|i| a.foliage_number[i] != b.foliage_number[i]),
        ),
        (
            "stem or none".to_owned(),
            share(&|i| (a.stem_depth[i] > 0.0) != (b.stem_depth[i] > 0.0)),
        ),
        (
            format!("light of stems beyond {APART}"),
            share(&|i| away(a.stem_normal[i][3], b.stem_normal[i][3])),
        ),
    ];
    if !a.shadow.is_empty() {
        let shadow = share(&|i| away(a.shadow[i], b.shadow[i]));
        found.push((format!("shadow beyond {APART}"), shadow));
    }
    let pixel = |i: usize| 8 * i..8 * i + 8;
    let apart = |i: usize| !alike(&pixels[pixel(i)], &others[pixel(i)]);
    found.push((PICTURE.to_owned(), share(&apart)));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::packing::f32_to_f16;

    fn drawing(number: u32, light: f32, ink: f32) -> (Maps, Vec<u8>) {
        let maps = Maps {
            size: [2, 1],
            foliage_number: vec![1, number],
            stem_depth: vec![0.0, 3.0],
            stem_normal: vec![[0.0; 4], [0.0, 0.0, 1.0, light]],
            ..Maps::default()
        };
        let pixel = |v: f32| f32_to_f16(v).to_le_bytes().repeat(4);
        (maps, [pixel(1.0), pixel(ink)].concat())
    }

    #[test]
    fn what_differs_is_counted_by_what_it_is() {
        let counts = |a, b| -> Vec<usize> {
            let found = compare(&a, &b);
            found.iter().map(|(_, share)| share.differing).collect()
        };
        let one = || drawing(7, 0.5, 0.2);
        assert_eq!(counts(one(), one()), [0, 0, 0, 0]);
        assert_eq!(counts(one(), drawing(8, 0.5, 0.2)), [1, 0, 0, 0]);
        assert_eq!(counts(one(), drawing(7, 0.6, 0.2)), [0, 0, 1, 0]);
        assert_eq!(counts(one(), drawing(7, 0.5, 0.25)), [0, 0, 0, 1]);
    }
}

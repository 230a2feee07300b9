//! Fitting: the inverse of the slab, local thickness, whole leaves with noise.

use umbrage::leaf::files::MapFormat;
use umbrage::leaf::fit::{
    Channel, FLOOR, FitInput, FitOptions, Fitted, PaperFailure, SideImages, Slab, clamp,
    exact_thickness, fit, invert, paper_iteration, paper_thickness, searched_thickness, solve,
};
use umbrage::leaf::slab_table::{Share, SlabTable};
use umbrage::leaf::species::{LeafSpecies, SPECIES};
use umbrage::leaf::{Face, LeafMaterial, Mode};
use umbrage::math::sampling::uniform;
use umbrage::math::slab::{self, Incidence};

/// Pairs of the exact solver, inverted by the table.
#[test]
fn slabs_come_back_from_what_they_reflect_and_let_through() {
    let (mut omega_error, mut delta_error, mut steps, mut count) = (0.0_f64, 0.0_f64, 0, 0);
    for i in 0..40 {
        let omega = 0.05 + 0.949 * f64::from(i) / 39.0;
        for j in 0..40 {
            let delta = 0.1 * 100f64.powf(f64::from(j) / 39.0);
            let s = slab::solve(omega, delta, Incidence::Beam(1.0)).unwrap();
            let found = solve(Share {
                r: s.rho_d,
                t: s.t_diff + s.t_dir,
            });
            omega_error = omega_error.max((found.slab.omega - omega).abs());
            delta_error = delta_error.max((found.slab.delta / delta).ln().abs());
            steps += found.steps;
            count += 1;
        }
    }
    println!(
        "omega {omega_error:.1e}, ln Delta {delta_error:.1e}, {:.1} steps",
        steps as f64 / count as f64
    );
    assert!(omega_error < 1e-4, "omega {omega_error}");
    assert!(delta_error < 1e-3, "ln Delta {delta_error}");
    assert!(steps < 8 * count, "{steps} steps for {count}");
}

/// The whole triangle R > 0, T > 0, R + T < 1 has answers, to its corners.
#[test]
fn every_pair_of_the_model_has_a_slab() {
    for i in 0..60 {
        for j in 0..60 - i {
            let at = |k: i32| FLOOR + (1.0 - 3.0 * FLOOR) * f64::from(k) / 59.0;
            let wanted = Share { r: at(i), t: at(j) };
            let found = invert(wanted);
            let again = SlabTable::shared().share(found.omega, found.delta);
            let error = (again.r - wanted.r).abs().max((again.t - wanted.t).abs());
            assert!(error < 1e-7, "{wanted:?} {found:?} {again:?}");
        }
    }
}

#[test]
fn what_no_slab_gives_is_moved_into_range() {
    for (r, t) in [
        (0.0, 0.5),
        (-0.1, 0.5),
        (0.7, 0.7),
        (f64::NAN, 0.2),
        (5.0, 1e-9),
        (f64::INFINITY, 0.1),
        (0.4, 0.5999),
    ] {
        let (share, moved) = clamp(r, t);
        assert!(moved, "{r} {t}");
        assert!(share.r >= FLOOR && share.t >= FLOOR, "{share:?}");
        assert!(share.r + share.t <= 1.0 - FLOOR + 1e-12, "{share:?}");
    }
    assert_eq!(clamp(0.3, 0.4), (Share { r: 0.3, t: 0.4 }, false));
}

/// Measured leaves: green of birch and goldenrod, red of an autumn leaf, infrared.
#[test]
fn measured_leaves_have_the_known_tissue() {
    for (r, t, omega, delta) in [
        (0.0741, 0.0835, 0.368, 2.757),
        (0.1699, 0.0835, 0.632, 3.189),
        (0.2589, 0.2472, 0.786, 2.178),
        (0.1581, 0.2025, 0.615, 2.074),
        (0.0857, 0.1016, 0.410, 2.592),
        (0.1262, 0.0503, 0.530, 3.554),
        (0.4297, 0.4210, 0.9532, 1.954),
        (0.485, 0.487, 0.992, 1.873),
    ] {
        let s = invert(Share { r, t });
        assert!((s.omega - omega).abs() < 6e-4, "{r} {t}: {s:?}");
        assert!(
            (s.delta - delta).abs() < 6e-4 * delta.max(1.0),
            "{r} {t}: {s:?}"
        );
    }
}

/// The paper's iteration is kept, and told how it fails.
#[test]
fn the_papers_iteration_fails_on_half_of_the_leaves() {
    let start = Slab {
        omega: 0.5,
        delta: 1.0,
    };
    let mut failures = 0;
    for s in SPECIES.iter().take(9) {
        for c in 0..3 {
            let target = Share {
                r: s.upper[c],
                t: s.through[c],
            };
            match paper_iteration(target, start) {
                Ok((slab, _)) => {
                    let exact = invert(target);
                    assert!((slab.omega - exact.omega).abs() < 1e-5, "{} {c}", s.name);
                }
                Err(_) => failures += 1,
            }
        }
    }
    println!("{failures} of 27 fail");
    assert!((9..=24).contains(&failures), "{failures}");
    let infrared = Share { r: 0.485, t: 0.487 };
    assert_eq!(
        paper_iteration(infrared, start),
        Err(PaperFailure::AlbedoAboveOne)
    );
}

/// How thick a vein is that lets half of the light through, by the table and by the paper.
#[test]
fn veins_have_the_known_thickness() {
    for (r, t, exact, paper, floor) in [
        (0.0741, 0.0835, 0.27, 0.39, 0.24),
        (0.1581, 0.2025, 0.41, 0.79, 0.38),
        (0.1262, 0.0503, 0.22, 0.60, 0.43),
    ] {
        let s = invert(Share { r, t });
        let column = SlabTable::shared().at(s.omega);
        let (_, b) = column.read(s.delta);
        let scattered = 0.5 * s.omega * b;
        let channel = |measured: f64| Channel {
            column: &column,
            delta: s.delta,
            mean: t,
            measured,
        };
        let found = exact_thickness(&[channel(0.5 * t)]);
        assert!((found - exact).abs() < 0.006, "exact {found} {exact}");
        let found = paper_thickness(s.delta, scattered, 0.5 * t).unwrap();
        assert!((found - paper).abs() < 0.01, "paper {found} {paper}");
        assert!(
            (scattered / t - floor).abs() < 0.01,
            "floor {}",
            scattered / t
        );
        assert_eq!(paper_thickness(s.delta, scattered, 0.99 * floor * t), None);
        // Beyond the bracket: its ends.
        assert!((exact_thickness(&[channel(1e-9)]) - 4.0).abs() < 1e-6);
        assert!((exact_thickness(&[channel(2.0)]) + 0.95).abs() < 1e-6);
    }
}

/// The fast search of the thickness against the slow one, for texels that no thickness explains.
#[test]
fn two_searches_find_one_thickness() {
    let leaf = LeafSpecies::parse("maple").unwrap().plain();
    let columns = [0, 1, 2].map(|c| SlabTable::shared().at(leaf.upper.omega(c)));
    let mean = [0.0984, 0.1361, 0.0146];
    let cost = |channels: &[Channel<'_>], d: f64| -> f64 {
        let term = |c: &Channel<'_>| {
            let t = c.column.share(c.delta * (1.0 + d)).t;
            ((t - c.measured) / c.mean.max(0.02)).powi(2)
        };
        channels.iter().map(term).sum()
    };
    for i in 0..1000u32 {
        let channels: Vec<Channel<'_>> = (0..3)
            .map(|c| Channel {
                column: &columns[c],
                delta: leaf.upper.sigma_t(c) * leaf.thickness_mm,
                mean: mean[c],
                measured: mean[c] * (6.0 * (uniform(9, 3 * i + c as u32) - 0.6)).exp2(),
            })
            .collect();
        let fast = cost(&channels, exact_thickness(&channels));
        let slow = cost(&channels, searched_thickness(&channels));
        assert!(fast <= slow * (1.0 + 1e-6) + 1e-9, "{i}: {fast} {slow}");
    }
}

/// Constant A and B under a thickness edit, against the slab.
#[test]
fn the_papers_constants_err_as_was_measured() {
    for (r, t, k, exact_t, paper_t) in [
        (0.0741, 0.0835, 0.5, 0.298, 0.272),
        (0.0741, 0.0835, 1.5, 0.0229, 0.0360),
        (0.0741, 0.0835, 2.0, 0.0062, 0.0240),
        (0.1581, 0.2025, 2.0, 0.0360, 0.0926),
        (0.485, 0.487, 0.25, 0.806, 0.959),
        (0.485, 0.487, 2.0, 0.298, 0.357),
    ] {
        let mut leaf = grey(r, t);
        leaf.thickness_mm *= k;
        let exact = f64::from(leaf.optics(Face::Upper).rho_t[1]);
        leaf.mode = Mode::Paper;
        let paper = f64::from(leaf.optics(Face::Upper).rho_t[1]);
        assert!(
            (exact - exact_t).abs() < 0.006 * exact_t + 6e-5,
            "{t} x{k}: {exact}"
        );
        assert!(
            (paper - paper_t).abs() < 0.006 * paper_t,
            "{t} x{k}: {paper}"
        );
    }
    // For a thin leaf the constants give back more than came in.
    let mut leaf = grey(0.485, 0.487);
    leaf.thickness_mm *= 0.25;
    leaf.mode = Mode::Paper;
    let o = leaf.optics(Face::Upper);
    assert!(o.rho_d[0] + o.rho_t[0] > 1.4, "{o:?}");
}

fn grey(r: f64, t: f64) -> LeafMaterial {
    let (side, clamped) = umbrage::leaf::Side::of_albedo([r; 3], [t; 3], 0.2);
    assert_eq!(clamped, 0);
    LeafMaterial {
        name: "grey".into(),
        thickness_mm: 0.2,
        mode: Mode::Exact,
        upper: side.clone(),
        lower: side,
        mask: None,
    }
}

const SIZE: [u32; 2] = [64, 64];

/// Images of a leaf as a camera would have them: relative noise on every channel.
fn images(leaf: &LeafMaterial, noise: f64) -> FitInput {
    let count = SIZE[0] * SIZE[1];
    let rough = |i: u32, k: u32| (1.0 + noise * 3.46 * (uniform(7 + k, i) - 0.5)) as f32;
    let mut input = FitInput {
        name: "again".into(),
        size: SIZE,
        thickness_mm: leaf.thickness_mm,
        mask: (0..count).map(|i| leaf.coverage(i as usize)).collect(),
        ..FitInput::default()
    };
    for face in Face::ALL {
        let sampler = leaf.sampler(face);
        let optics: Vec<_> = (0..count).map(|i| sampler.of(i as usize)).collect();
        let side = SideImages {
            reflectance: (0..count)
                .zip(&optics)
                .map(|(i, o)| [0, 1, 2].map(|c| o.rho_d[c] * rough(i, c as u32)))
                .collect(),
            specular: optics.iter().map(|o| o.rho_s).collect(),
            roughness: optics.iter().map(|o| o.m).collect(),
        };
        match face {
            Face::Upper => {
                input.transmittance = (0..count)
                    .zip(&optics)
                    .map(|(i, o)| [0, 1, 2].map(|c| o.rho_t[c] * rough(i, 10 + c as u32)))
                    .collect();
                input.upper = side;
            }
            Face::Lower => input.lower = side,
        }
    }
    input
}

fn fitted(input: &FitInput, mode: Mode) -> Fitted {
    let options = FitOptions {
        mode,
        ..FitOptions::default()
    };
    fit(input, &options, &|_, _| {}).unwrap()
}

/// A leaf of one tissue, with noise: its tissue comes back.
#[test]
fn an_even_leaf_comes_back_through_noise() {
    let leaf = LeafSpecies::parse("goldenrod").unwrap().plain();
    let input = images(&leaf, 0.02);
    let again = fitted(&input, Mode::Exact);
    for face in [Face::Upper] {
        for c in 0..3 {
            let (found, known) = (again.material.side(face), leaf.side(face));
            assert!(
                (found.omega(c) - known.omega(c)).abs() < 2e-3,
                "{face:?} {c}: {} {}",
                found.omega(c),
                known.omega(c)
            );
            let ratio = found.sigma_t(c) / known.sigma_t(c);
            assert!((ratio - 1.0).abs() < 2e-3, "{face:?} {c}: {ratio}");
        }
    }
    assert_eq!(again.residuals[0].clamped, 0);
}

/// Leaves with veins: what is drawn from the fit is what was measured, and the fitted thickness
/// follows the known one.
#[test]
fn drawn_leaves_come_back_through_noise() {
    for name in ["goldenrod", "maple"] {
        let leaf = LeafSpecies::parse(name).unwrap().drawn(SIZE);
        let input = images(&leaf, 0.01);
        let again = fitted(&input, Mode::Exact);
        let sampler = again.material.sampler(Face::Upper);
        let (mut error, mut sum, mut weight) = ([0.0; 2], [0.0; 2], 0.0);
        let (known, found) = (
            leaf.upper.maps.clone().unwrap(),
            again.material.upper.maps.clone().unwrap(),
        );
        let (mut pairs, mut deltas) = (Vec::new(), Vec::new());
        for i in 0..input.mask.len() {
            let w = f64::from(input.mask[i]);
            if w <= 0.0 {
                continue;
            }
            let o = sampler.of(i);
            for c in 0..3 {
                let (r, t) = (input.upper.reflectance[i][c], input.transmittance[i][c]);
                error[0] += w * f64::from(o.rho_d[c] - r).powi(2);
                error[1] += w * f64::from(o.rho_t[c] - t).powi(2);
                sum[0] += w * f64::from(r).powi(2);
                sum[1] += w * f64::from(t).powi(2);
            }
            weight += w;
            pairs.push(f64::from(known.gamma_delta[i][3]));
            deltas.push(f64::from(found.gamma_delta[i][3]));
        }
        let relative = [0, 1].map(|k| (error[k] / sum[k]).sqrt());
        let correlation = umbrage::math::stats::pearson(&pairs, &deltas);
        println!(
            "{name}: R {:.4} T {:.4} thickness {correlation:.4}",
            relative[0], relative[1]
        );
        assert!(weight > 500.0);
        assert!(relative[0] < 0.002, "reflectance {}", relative[0]);
        assert!(relative[1] < 0.03, "transmittance {}", relative[1]);
        assert!(correlation > 0.98, "thickness {correlation}");
        assert_eq!(again.material.upper.maps.as_ref().unwrap().size, SIZE);
    }
}

/// The paper's closed form loses the veins.
#[test]
fn the_papers_fit_is_worse_and_says_so() {
    let leaf = LeafSpecies::parse("maple").unwrap().drawn(SIZE);
    let input = images(&leaf, 0.0);
    let exact = fitted(&input, Mode::Exact);
    let paper = fitted(&input, Mode::Paper);
    let rms = |f: &Fitted| f.residuals[0].rms[1];
    println!("RMS of T: exact {} paper {}", rms(&exact), rms(&paper));
    assert!(
        rms(&paper) > 3.0 * rms(&exact),
        "{} {}",
        rms(&paper),
        rms(&exact)
    );
    assert_eq!(exact.residuals[0].without_thickness, 0);
    assert!(paper.residuals[0].without_thickness > 0);
    assert_eq!(exact.residuals[0].iteration_failures, [0; 3]);
    let failures: usize = paper.residuals[0].iteration_failures.iter().sum();
    println!(
        "iteration: {:?} of {}",
        paper.residuals[0].iteration_failures,
        3 * paper.texels
    );
    assert!(
        failures > paper.texels / 2,
        "{failures} of {}",
        paper.texels
    );
}

#[test]
fn bad_images_are_refused_and_bad_texels_counted() {
    let leaf = LeafSpecies::parse("goldenrod").unwrap().drawn(SIZE);
    let good = images(&leaf, 0.0);
    let options = FitOptions::default();
    let refused = |change: fn(&mut FitInput), word: &str| {
        let mut input = good.clone();
        change(&mut input);
        let error = fit(&input, &options, &|_, _| {}).unwrap_err().to_string();
        assert!(error.contains(word), "{word:?} in {error}");
    };
    refused(|i| i.mask.clear(), "no leaf mask");
    refused(|i| i.mask.fill(0.0), "mask is empty");
    refused(|i| i.thickness_mm = -0.2, "thickness");
    refused(
        |i| i.transmittance.truncate(7),
        "transmittance has 7 texels",
    );
    refused(|i| i.lower.roughness.push(0.3), "lower roughness");
    refused(|i| i.size = [0, 4], "empty");
    let mut odd = good.clone();
    let middle = (SIZE[0] * SIZE[1] / 2 + SIZE[0] / 2) as usize;
    assert!(odd.mask[middle] > 0.0);
    odd.transmittance[middle] = [0.9, -0.2, f32::NAN];
    odd.upper.reflectance[middle] = [0.9, 0.1, 0.1];
    let found = fit(&odd, &options, &|_, _| {}).unwrap();
    assert_eq!(
        found.residuals[0].clamped,
        fitted(&good, Mode::Exact).residuals[0].clamped + 1
    );
    let o = found.material.sampler(Face::Upper).of(middle);
    assert!(
        (0..3).all(|c| o.rho_d[c].is_finite() && o.rho_t[c].is_finite()),
        "{o:?}"
    );
}

/// Two runs agree in every bit, whatever the threads did.
#[test]
fn fits_repeat() {
    let leaf = LeafSpecies::parse("birch-autumn").unwrap().drawn(SIZE);
    let input = images(&leaf, 0.01);
    let file = |f: &Fitted| umbrage::leaf::files::encode(&f.material, "a", MapFormat::Exr).unwrap();
    let (a, b) = (fitted(&input, Mode::Exact), fitted(&input, Mode::Exact));
    assert!(file(&a) == file(&b));
}

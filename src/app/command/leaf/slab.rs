//! `umbrage leaf slab`: the solver by itself.

use serde_json::json;

use crate::Result;
use crate::app::Report;
use crate::app::cli::leaf::SlabArgs;
use crate::math::slab::{Incidence, solve};

pub(super) fn run(args: &SlabArgs) -> Result<Report> {
    let incidence = if args.diffuse {
        Incidence::Diffuse
    } else {
        Incidence::Beam(args.mu0)
    };
    let light = solve(args.omega, args.delta, incidence)?;
    let sum = light.rho_d + light.t_diff + light.t_dir;
    let from = match incidence {
        Incidence::Beam(mu0) => format!("mu0 {mu0}"),
        Incidence::Diffuse => "diffuse light".to_owned(),
    };
    let text = format!(
        "omega {} Delta {} {from}\n\
         rho_d   {:.9}\nt_diff  {:.9}\nt_dir   {:.9}\nabsorbed {:.9}\nA {:.9}\nB {:.9}\n",
        args.omega,
        args.delta,
        light.rho_d,
        light.t_diff,
        light.t_dir,
        1.0 - sum,
        light.a,
        light.b,
    );
    let json = json!({
        "omega": args.omega, "delta": args.delta,
        "incidence": if args.diffuse { json!("diffuse") } else { json!(args.mu0) },
        "rho_d": light.rho_d, "t_diff": light.t_diff, "t_dir": light.t_dir,
        "rho_t": light.t_diff + light.t_dir, "absorbed": 1.0 - sum, "A": light.a, "B": light.b,
    });
    Ok(Report::new(text, json))
}

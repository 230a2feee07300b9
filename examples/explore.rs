use glam::{DVec3, Vec3};
use umbrage::app::tradeoff::truth::Truth;
use umbrage::foliage::Split;
use umbrage::reference::{ambient::*, density::*, generators::*, realign::*};
use umbrage::math::{sampling::fibonacci_directions, stats};
use umbrage::scene::{Geometry, import};
use rayon::prelude::*;
fn main() {
    for path in std::env::args().skip(1) {
        let t0=std::time::Instant::now();
        let model = import::load(&path, &Default::default()).unwrap();
        let g = Geometry::flatten(&model);
        let split = Split::new(&model, &g, None).unwrap();
        let truth = Truth::trace(&model, &g, &split, 1500).unwrap();
        let (min,max)=split.bounds(&g); let c=0.5*(min+max).as_dvec3(); let d=(max-min).as_dvec3().length();
        let pos: Vec<[f32;3]> = g.positions.iter().map(|p| ((p.as_dvec3()-c)/d).as_vec3().to_array()).collect();
        let gens = generators(&pos,&split.foliage_indices,Source::Leaf).unwrap();
        let tris = generators(&pos,&split.foliage_indices,Source::Triangle).unwrap();
        let area: f64 = gens.iter().map(|g|g.area).sum();
        println!("## {path} foliage v {} gens {} tri {} sample {} area {:.3} trace {:.1}s mean amb {:.3} diag {d:.2}", split.foliage_vertices.len(), gens.len(), tris.len(), truth.sample.len(), area, t0.elapsed().as_secs_f64(), truth.mean_ambient());
        let q = |v: usize| DVec3::from(pos[v].map(f64::from));
        let n = pos.len();
        let per = |f: &(dyn Fn(DVec3)->Option<DVec3>+Sync)| -> Vec<Vec3> {
            let fol: Vec<(usize,Vec3)> = split.foliage_vertices.par_iter().map(|&v| (v as usize, f(q(v as usize)).map(|x|x.as_vec3()).unwrap_or(g.normals[v as usize]))).collect();
            let mut out=vec![Vec3::Y;n]; for (i,x) in fol {out[i]=x;} out };
        let show = |name:&str, nn:&[Vec3]| println!("  {name:28} AUC {:.3} rough {:.2}", truth.auc(nn), truth.roughness(&g,nn));
        show("original", &g.normals);
        show("sphere", &per(&|q| q.try_normalize()));
        println!("  {:28} AUC {:.3}", "limit", truth.auc(&truth.open_directions(n)));
        for rho in [0.05,0.08,0.1,0.12,0.16,0.2] {
            let f=Field::new(&gens,rho,Norm::Euclidean); let w=Field::new(&gens,2.0*rho,Norm::Euclidean);
            show(&format!("gradient {rho}"), &per(&|q| gradient_normal(q,&f,&w)));
            if rho<0.13 {show(&format!("multiscale {rho}"), &per(&|q| multiscale_normal(q,&f,&w)));}
        }
        let (b0,b1)=bounds(&gens);
        for ra in [0.02,0.03,0.05] { for cells in [32,64] { for dirs in [6,16,32] {
            if ra!=0.03 && (cells!=64|| dirs!=32) {continue}
            let f=Field::leaf_area(&gens,ra); let grid=Grid::around(b0,b1,ra,cells); let vals=f.density_grid(&grid);
            let dd=fibonacci_directions(dirs);
            for ext in [0.5] {
            show(&format!("open {ra} cells {cells} dirs {dirs} ext {ext}"), &per(&|q| open_normal(&grid,&vals,q,&dd,ext)));
            let mut amb=vec![0f32;n]; let a: Vec<(usize,f32)>=truth.sample.par_iter().map(|&v|(v,mean_transmittance(&grid,&vals,q(v),&dd,ext) as f32)).collect(); for (v,x) in a {amb[v]=x;}
            let m=stats::mean(&truth.sample.iter().map(|&v| amb[v] as f64).collect::<Vec<_>>());
            println!("     ambient spearman {:.3} mean {:.3}", truth.spearman(&amb), m);
        }}}}
        for ra in [0.015,0.02,0.025,0.03,0.04,0.06,0.1] {
            for (nm,gg) in [("leaf",&gens),("area",&gens),("tri",&tris)] {
            let f= if nm=="area" {Field::leaf_area(gg,ra)} else {Field::new(gg,ra,Norm::Euclidean)};
            let mut amb=vec![0f32;n]; let a: Vec<(usize,f32)>=truth.sample.par_iter().map(|&v|(v,-f.density(q(v)) as f32)).collect(); for (v,x) in a {amb[v]=x;}
            print!("  eq4 {nm} {ra}: {:.3}", truth.spearman(&amb)); } println!();
        }
    }
}

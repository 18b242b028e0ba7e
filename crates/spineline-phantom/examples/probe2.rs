//! probe
use spineline::curve::*;
use spineline::warning::Warnings;
use spineline_phantom::*;
fn main() {
    let i: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let p = generate(i, Truth::Rod, &Readers::exact(), 1).unwrap();
    let mut w = Warnings::default();
    let o = spineline::measure::measure_film(&p.case.films[0], &mut w).unwrap();
    for v in &o.vertebrae {
        print!("{} {:.1} {:.1} {:.1}; ", v.level, v.location.y_mm, v.location.z_mm, v.tilt.deg());
    }
    println!();
    for k in 4..=12 {
        let f = fit_curve(&o, OrderRule::Fixed(k), &mut w).unwrap();
        println!(
            "{k} {:.3} {:.3} loo {:.3} {:?}",
            f.rmse_mm,
            f.rmse_tilt.deg(),
            f.left_out,
            f.curve.form()
        );
    }
}

//! x
mod common;
use common::*;
use spineline::analysis::*;
use spineline::personalize::*;
use spineline::spatial::*;
use spineline_phantom::*;
#[test]
fn spread() {
    // per model: rel multiplier difference under tiny film moves vs rms
    let mut rows = vec![];
    for i in 0..18 {
        for truth in Truth::ALL {
            for (k, r) in [Readers::exact(), Readers::default()].iter().enumerate() {
                for target in [FitTarget::Shape, FitTarget::Ferguson] {
                    let case = phantom(i, truth, r).case;
                    let mut moved = case.clone();
                    for (j, f) in moved.films.iter_mut().enumerate() {
                        move_landmarks(f, Angle::from_deg(3.0 + j as f64), Frontal::new(10.0, 7.0));
                    }
                    let o = AnalysisOptions { target, ..on_a_table() };
                    let (a, b) = (analyzed(&case, &o), analyzed(&moved, &o));
                    for (m, n) in a.models.iter().zip(&b.models) {
                        let d = m
                            .multipliers()
                            .zip(n.multipliers())
                            .map(|(x, y)| (x / y - 1.0).abs())
                            .fold(0.0, f64::max);
                        rows.push((
                            d,
                            (m.fit.residual_rms - n.fit.residual_rms).abs() / m.fit.residual_rms,
                            format!(
                                "{i} {truth:?} {k} {target:?} {:?} rms {:.3} {:?} it {} {}",
                                m.kind,
                                m.fit.residual_rms,
                                m.fit.status,
                                m.fit.iterations,
                                n.fit.iterations
                            ),
                        ));
                    }
                }
            }
        }
    }
    rows.sort_by(|a, b| b.0.total_cmp(&a.0));
    for r in rows.iter().take(25) {
        println!("{:.2e} {:.2e} {}", r.0, r.1, r.2);
    }
    for lim in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
        println!("> {lim}: {} of {}", rows.iter().filter(|r| r.0 > lim).count(), rows.len());
    }
}

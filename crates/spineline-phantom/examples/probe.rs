//! probe
use spineline::analysis::*;
use spineline::anatomy::*;
use spineline::multibody::Support;
use spineline_phantom::*;
fn main() {
    let noisy = std::env::args().nth(1).as_deref() == Some("noisy");
    let free = std::env::args().nth(2).as_deref() == Some("free");
    let readers = if noisy { Readers::default() } else { Readers::exact() };
    for truth in Truth::ALL {
        for i in 0..18 {
            let p = match generate(i, truth, &readers, 1) {
                Ok(p) => p,
                Err(e) => {
                    println!("{e}");
                    continue;
                }
            };
            let o = AnalysisOptions {
                support: if free { Support::Free } else { Support::Frontal },
                ..Default::default()
            };
            let oj = AnalysisOptions { grouping: Grouping::PerJoint, ..o.clone() };
            let t = std::time::Instant::now();
            let a = match analyze(&p.case, &o) {
                Ok(a) => a,
                Err(e) => {
                    println!("{} {e}", p.case.id);
                    continue;
                }
            };
            let dt = t.elapsed();
            let aj = analyze(&p.case, &oj).unwrap();
            let inf = a
                .inflections
                .pair
                .map(|pr| [0, 1].map(|k| pr[k].erect.distance_mm(p.postures[0].inflections[k])));
            print!(
                "{} {:?} ord {:?} n {} inf {:?} ",
                p.case.id,
                dt,
                a.postures.iter().map(|q| q.fit.order).collect::<Vec<_>>(),
                a.chain.segments,
                inf.map(|x| x.map(|v| (v * 100.).round() / 100.))
            );
            for (q) in a.postures.iter().skip(1).take(2) {
                print!(
                    "rmse {:.3}/{:.3} amp {:.1} ",
                    q.fit.rmse_mm,
                    q.fit.rmse_tilt.deg(),
                    q.outline.amplitude().deg()
                );
                if let (Some(tl), Some(pts)) =
                    (p.posture(q.outline.posture).unwrap().line, q.inflection_points)
                {
                    let l = spineline::action::LineOfAction::through(pts[0], pts[1]);
                    if let Ok(l) = l {
                        print!("dline {:.2}° ", l.angle_to(&tl).deg());
                    }
                }
            }
            println!();
            for m in &a.models {
                print!("   {:16}", m.kind);
                for (g, t) in m.multipliers().zip(p.multipliers) {
                    print!(" {:.2}({:.2})", g, t);
                }
                print!(
                    " {} it {} st {} rms {:.3} |",
                    m.fit.status.key(),
                    m.fit.iterations,
                    m.fit.starts,
                    m.fit.residual_rms
                );
                for s in &m.postures {
                    print!(
                        " {}:{:.2}mm F{:.0}{} c{}",
                        &s.posture.key()[..2],
                        s.mean_location_error_mm(),
                        s.force_n,
                        if s.is_usable() { "" } else { "!" },
                        s.contradicted.len()
                    );
                }
                let mj = aj.models.iter().find(|x| x.kind == m.kind).unwrap();
                print!(" | per joint {} it{}", mj.fit.status.key(), mj.fit.iterations);
                for s in mj.postures.iter() {
                    print!(" {:.2}", s.mean_location_error_mm());
                }
                println!();
            }
        }
    }
}

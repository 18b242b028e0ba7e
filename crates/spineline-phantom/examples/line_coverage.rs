//! How often regions and tests of the line of action are right, on synthetic patients whose line is known.
use nalgebra::Matrix4;
use spineline::analysis::{Analysis, AnalysisOptions, analyze};
use spineline::personalize::{Crossing, Proposal};
use spineline_phantom::{Phantom, Readers, SUBJECTS, Truth, generate};

fn main() {
    let seeds: u64 = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(4);
    for truth in [Truth::Rod, Truth::Pull] {
        let mut counts = std::collections::BTreeMap::<String, [usize; 2]>::new();
        let (mut sds, mut dfs) = (Vec::new(), Vec::new());
        for seed in 1..=seeds {
            for index in 0..SUBJECTS.len() {
                let Ok(phantom) = generate(index, truth, &Readers::default(), seed) else {
                    continue;
                };
                let Ok(analysis) = analyze(&phantom.case, &AnalysisOptions::default()) else {
                    continue;
                };
                one(&phantom, &analysis, &mut |what, right| {
                    let count = counts.entry(what).or_default();
                    count[0] += usize::from(right);
                    count[1] += 1;
                });
                if let Some(line) = analysis.postures[1].preferred_line.as_ref() {
                    sds.push(line.joint_log_sd);
                    if let Some(c) = line.inflection {
                        dfs.push(c.test.freedom);
                    }
                }
            }
        }
        println!("{}", truth.key());
        for (what, [right, all]) in counts {
            println!("  {what}: {right} of {all}, {:.1} %", 100.0 * right as f64 / all as f64);
        }
        sds.sort_by(f64::total_cmp);
        dfs.sort_by(f64::total_cmp);
        println!("  joint sd {:?}", [0.1, 0.5, 0.9].map(|q| sds[(q * sds.len() as f64) as usize]));
        if !dfs.is_empty() {
            println!(
                "  freedom {:?}",
                [0.1, 0.5, 0.9].map(|q| dfs[(q * dfs.len() as f64) as usize])
            );
        }
    }
}

fn one(phantom: &Phantom, analysis: &Analysis, count: &mut dyn FnMut(String, bool)) {
    let Some(loads) = analysis.preferred_loads() else { return count("estimated".into(), false) };
    let moved = analysis.postures.iter().filter(|p| p.evidence.is_some());
    for (film, posture) in moved.enumerate() {
        let name = posture.outline.posture;
        let truth = phantom.posture(name).expect("the same films");
        let Some(line) = truth.line else { continue };
        let noise = posture.outline.noise;
        let heights = [60.0, 200.0];
        let points = heights
            .map(|z| line.point + line.direction * ((z - line.point.z_mm) / line.direction.z_mm));
        let points = if line.direction.z_mm.abs() > 0.2 {
            points
        } else {
            [line.point, line.point + line.direction * 100.0]
        };
        // The frame of a film is L4's, which was measured too: it turns about L4 and shifts with it.
        let turn = noise.tilt.rad();
        let by: [f64; 4] = [points[0].z_mm, -points[0].y_mm, points[1].z_mm, -points[1].y_mm];
        let covariance = Matrix4::from_fn(|i, j| {
            by[i] * by[j] * turn * turn
                + if i % 2 == j % 2 { noise.location_mm.powi(2) } else { 0.0 }
        });
        if let Some(test) = loads.test(film, &Proposal::Through { points, covariance }) {
            count(format!("{name}: true line in the region"), !test.rejects());
        }
        if let Some(own) = &posture.preferred_line {
            if let Some(against) = own.inflection {
                count(format!("{name}: not rejected: inflections"), !against.test.rejects());
            }
            if let Some(test) = own.iliac {
                count(format!("{name}: not rejected: iliac"), !test.rejects());
            }
            for at in own.crossings {
                let y = line.point.y_mm
                    + (at.z_mm - line.point.z_mm) * line.direction.y_mm / line.direction.z_mm;
                match at.within {
                    Crossing::Between([a, b]) => {
                        count(format!("{name}: crossing covers"), (a..=b).contains(&y))
                    }
                    Crossing::Open => count(format!("{name}: crossing open"), true),
                }
            }
        } else {
            count(format!("{name}: a line"), false)
        }
    }
}

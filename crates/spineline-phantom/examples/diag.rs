use spineline::analysis::analyze;
use spineline::multibody::{JointGroups, Load};
use spineline_phantom::{Readers, Truth, generate};
fn main() {
    for index in [0usize, 1, 4] {
        let phantom = generate(index, Truth::Rod, &Readers::exact(), 1).unwrap();
        let analysis = analyze(&phantom.case, &Default::default()).unwrap();
        let loads = analysis.preferred_loads().unwrap();
        let groups = JointGroups::regional(&analysis.regions);
        println!(
            "subject {index} higher {} sd {} c {} multipliers true {:?} est {:?}",
            loads.centres_higher_mm,
            loads.centre_sd_mm,
            loads.joint_log_sd,
            phantom.multipliers.map(f64::ln),
            loads.log_multipliers
        );
        for (film, p) in
            analysis.postures.iter().filter(|p| p.evidence.is_some()).enumerate().take(2)
        {
            let e = p.evidence.as_ref().unwrap();
            let truth = phantom.posture(p.outline.posture).unwrap();
            let line = truth.line.unwrap();
            let w = [
                line.direction.y_mm * truth.force_n,
                line.direction.z_mm * truth.force_n,
                line.point.cross(line.direction) * truth.force_n,
            ];
            println!(" {} est {:?} true {:?}", p.outline.posture, loads.components[film], w);
            for (j, (r, joint)) in
                e.responses(&Load::Frontal { depth_mm: 0.0 }).iter().zip(&e.joints).enumerate()
            {
                let g = groups.of_joint()[j];
                let est: f64 = (0..3).map(|i| r[i] * loads.components[film][i]).sum::<f64>()
                    * (-loads.log_multipliers[g]).exp();
                let tru: f64 = (0..3).map(|i| r[i] * w[i]).sum::<f64>() / phantom.multipliers[g];
                println!(
                    "  {j:2} g{g} rot {:8.3} est {:8.3} true-load {:8.3} ratio {:6.3} hinge.x {:.3}",
                    joint.rotation.deg(),
                    est.to_degrees(),
                    tru.to_degrees(),
                    joint.rotation.rad() / tru,
                    joint.hinge.x
                );
            }
        }
    }
}

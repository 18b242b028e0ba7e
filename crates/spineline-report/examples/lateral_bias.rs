//! Writes the figure of a tilted vertebra on a lateral film: `docs/guide/src/lateral-bias.svg`.

fn main() {
    print!("{}", spineline_report::figures::lateral_bias());
}

//! Writes the figure of what a lateral film shows of a tilted vertebra: `docs/guide/src/lateral-bias.svg`.

fn main() {
    print!("{}", spineline_report::figures::lateral_bias());
}

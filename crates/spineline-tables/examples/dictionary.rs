//! Writes the guide's page about the columns of the tables and the codes of warnings.

fn main() {
    print!(
        "# What every column means\n\n\
         Made by `cargo run -p spineline-tables --example dictionary` from the definitions that fill the tables and give the warnings.\n\
         `analyze --tables DIR` writes the same about its own tables as `dictionary.csv`. The last nine tables are of other options and commands:\n\
         `chain` of `analyze --chain`, `errors` of `analyze --csv` and of `reproduce`, `cohort_tests` of `analyze --cohort`,\n\
         `noise_study` of `noise-study`, `path` of `simulate --csv`, `loaded_measures` of `simulate --measures`,\n\
         `statistics` of `reliability --csv`, `summary` of `reproduce`, `verdicts` of `import`.\n\n{}",
        spineline_tables::dictionary_markdown()
    );
}

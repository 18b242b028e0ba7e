//! Writes the guide's page about the columns of the tables.

fn main() {
    print!(
        "# What every column means\n\n\
         Made by `cargo run -p spineline-tables --example dictionary` from the definitions that fill the tables.\n\
         `analyze --tables DIR` writes the same as `dictionary.csv`.\n\n{}",
        spineline_tables::dictionary_markdown()
    );
}

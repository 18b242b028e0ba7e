//! Prints the description of the interface, of which the browser's types are made.

fn main() {
    let description = spineline_server::openapi();
    println!("{}", description.to_pretty_json().expect("a description is JSON"));
}

//! Prints the description of the interface, from which the browser's types are generated.

fn main() {
    let description = spineline_server::openapi();
    println!("{}", description.to_pretty_json().expect("a description is JSON"));
}

//! Decodes one film from its input to its output, as the server's decoder process does.

fn main() -> std::io::Result<()> {
    spineline_films::serve_child(&mut std::io::stdin().lock(), &mut std::io::stdout().lock())
}

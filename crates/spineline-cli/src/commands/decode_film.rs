//! `spineline decode-film`: the child process that decodes one film; not for people.

use spineline_films::serve_child;

use crate::run::failure::{Ending, Failure};

pub fn run() -> Result<Ending, Failure> {
    let mut output = std::io::stdout().lock();
    serve_child(&mut std::io::stdin().lock(), &mut output)
        .map_err(|error| Failure::write("the decoder's answer", &error))?;
    Ok(Ending::Done)
}

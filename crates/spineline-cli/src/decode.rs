//! `spineline decode-film`: the child's side of decoding a film in a process of its own. Not for people.

use crate::failure::{Ending, Failure};

pub fn run() -> Result<Ending, Failure> {
    let mut output = std::io::stdout().lock();
    spineline_io::film::serve_child(&mut std::io::stdin().lock(), &mut output)
        .map_err(|error| Failure::write("the decoder's answer", &error))?;
    Ok(Ending::Done)
}

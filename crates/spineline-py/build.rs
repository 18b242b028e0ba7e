//! Gives the native module its build identity.

fn main() -> std::io::Result<()> {
    spineline_build::emit()
}

//! Sets the build identity of the native module.

fn main() -> std::io::Result<()> {
    spineline_build::emit()
}

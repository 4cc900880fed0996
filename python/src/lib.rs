//! The extension module `lss._lss`: what the Python package `lss` calls. It takes plain values and gives JSON, bytes and
//! NumPy arrays; the package's Python makes data frames of them.

mod build;
mod capacity;
mod choose;
mod command_line;
mod diagnose;
mod identify;
mod raise;
mod runs;
mod simulate;
mod work;

use pyo3::prelude::*;

#[pymodule]
fn _lss(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(command_line::loaded, module)?)?;
    module.add_function(wrap_pyfunction!(command_line::main, module)?)?;
    module.add_function(wrap_pyfunction!(build::build, module)?)?;
    module.add_function(wrap_pyfunction!(capacity::capacity, module)?)?;
    module.add_function(wrap_pyfunction!(choose::choose, module)?)?;
    module.add_function(wrap_pyfunction!(runs::read_run, module)?)?;
    module.add_function(wrap_pyfunction!(runs::write_run, module)?)?;
    module.add_function(wrap_pyfunction!(runs::position, module)?)?;
    module.add_function(wrap_pyfunction!(runs::channels, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(identify::identify, module)?)?;
    module.add_function(wrap_pyfunction!(diagnose::diagnose, module)?)?;
    module.add_class::<build::Layout>()?;
    module.add_class::<capacity::Capacity>()?;
    module.add_class::<simulate::Simulation>()?;
    module.add_class::<runs::Sidecar>()?;
    Ok(())
}

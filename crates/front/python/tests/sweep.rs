//! Sweeps, on this machine and on a simulated cluster. Apart from the other tests in Python, because they take as long.

use elbowroom_testkit::python::with_modules;

use crate::package::Package;

#[test]
fn sweeps_lose_nothing_and_count_nothing_twice() {
    if with_modules("pyarrow, ray, scipy, matplotlib", "pyarrow, Ray, SciPy and matplotlib").is_none() {
        return;
    }
    let Some(package) = Package::new() else { return };
    package.run(&["pytest", "-q", "-p", "no:cacheprovider", "python/tests/test_sweep.py"]);
}

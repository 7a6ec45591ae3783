//! Tests that measure what a whole process takes, each in a process of its own.

use std::process::Command;

/// The variable by which a process knows that it runs one test alone.
const ALONE: &str = "TEST_IN_ITS_OWN_PROCESS";

/// Runs the test `name` (with its modules) in a new process and fails as it fails there; `true` within that
/// process, where the measuring is to be done.
pub(crate) fn is_alone(name: &str) -> bool {
    if std::env::var_os(ALONE).is_some() {
        return true;
    }
    let mut command = Command::new(std::env::current_exe().unwrap());
    let output = command.args([name, "--exact", "--include-ignored", "--nocapture"]).env(ALONE, "1").output();
    let output = output.unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("1 passed"), "no test of the name {name}: {said}");
    false
}

/// Most memory that this process ever had, KiB.
pub(crate) fn peak_kib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or_default()
}

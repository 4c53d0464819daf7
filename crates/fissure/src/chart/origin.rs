//! On what the numbers of a chart were measured.

use std::fmt;

/// Machine and program, and how much was measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Origin {
    machine: String,
    instructions: &'static str,
    threads: usize,
    revision: &'static str,
    quick: bool,
}

impl Origin {
    /// Of this program on this machine.
    pub(super) fn of_now(threads: usize, quick: bool) -> Self {
        let brand = sysinfo::System::new().ok().and_then(|mut system| {
            system.refresh_cpu_all();
            system.cpus().first().map(|cpu| cpu.brand().trim().to_owned())
        });
        // It goes into a line of a table.
        let machine =
            brand.filter(|name| !name.is_empty()).unwrap_or_else(|| "unknown processor".into()).replace(',', ";");
        let revision = env!("FISSURE_REVISION");
        let revision = if revision.is_empty() { "unknown" } else { revision };
        Self { machine, instructions: fissure_sim::widest_instructions(), threads, revision, quick }
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let threads = if self.threads == 1 { "thread" } else { "threads" };
        write!(
            f,
            "{}, {}, {} {threads}, f64, version {} of revision {}{}",
            self.machine,
            self.instructions,
            self.threads,
            env!("CARGO_PKG_VERSION"),
            self.revision,
            if self.quick { ", quick" } else { "" }
        )
    }
}

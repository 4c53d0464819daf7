//! How much memory the system has left for this process.

/// Memory that this process can still get [bytes]: what the machine has free, within the limits of its control group
/// and of its address space. None where the system does not say, or is not asked: without the feature `system`.
pub(crate) fn available() -> Option<u64> {
    #[cfg(feature = "system")]
    return system::available();
    #[cfg(not(feature = "system"))]
    None
}

#[cfg(feature = "system")]
mod system {
    pub(super) fn available() -> Option<u64> {
        let free = sysinfo::System::new().ok().and_then(|mut system| {
            system.refresh_memory();
            let machine = Some(system.available_memory()).filter(|&bytes| bytes > 0);
            machine.into_iter().chain(system.cgroup_limits().map(|limits| limits.free_memory)).min()
        });
        free.into_iter().chain(address_space()).min()
    }

    /// Address space that one thread takes besides what it computes: its stack, and the arena that the allocator of
    /// Linux gives it [bytes].
    #[cfg(unix)]
    const THREAD: u64 = (2 + 64) << 20;

    /// What is left of the address space of this process [bytes] where `ulimit -v` limits it: without what it has
    /// mapped, and without the threads that are yet to come, which make meshes and draw the bar.
    #[cfg(unix)]
    fn address_space() -> Option<u64> {
        let limit = rustix::process::getrlimit(rustix::process::Resource::As).current?;
        let to_come = crate::threads::current_num_threads() as u64 / 2 + 2;
        Some(limit.saturating_sub(mapped()).saturating_sub(to_come * THREAD))
    }

    /// Address space that this process has mapped [bytes]; 0 where the system does not say.
    #[cfg(unix)]
    fn mapped() -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let size = status.lines().find_map(|line| line.strip_prefix("VmSize:"));
        let kibibytes = size.and_then(|size| size.split_whitespace().next()?.parse::<u64>().ok());
        kibibytes.unwrap_or(0) << 10
    }

    /// Other systems have no such limit.
    #[cfg(not(unix))]
    fn address_space() -> Option<u64> {
        None
    }
}

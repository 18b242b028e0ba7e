//! Full disks, where the tests may mount them: `SPINELINE_MOUNT_SMALL_DISKS=1`, as
//! `cargo xtask test --full` sets it.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use spineline_store::{Store, StoreError};

use crate::session::{
    STEPS, by, fingerprint, folder, folder_with_store, reference, run, try_fingerprint,
};

/// A separate small disk, if this user may create one.
struct SmallDisk<'a> {
    path: &'a Path,
}

impl<'a> SmallDisk<'a> {
    fn mount(path: &'a Path, kib: u32) -> Option<Self> {
        if std::env::var_os("SPINELINE_MOUNT_SMALL_DISKS").is_none() {
            println!("skipped: SPINELINE_MOUNT_SMALL_DISKS is not set");
            return None;
        }
        let size = format!("size={kib}k");
        let arguments = ["-t", "tmpfs", "-o", &size, "tmpfs"];
        let mounted = Command::new("mount").args(arguments).arg(path).output();
        if mounted.is_ok_and(|output| output.status.success()) {
            return Some(Self { path });
        }
        println!("skipped: this user cannot mount a small disk");
        None
    }

    /// Gives the disk another size.
    fn resize(&self, kib: u32) {
        let size = format!("remount,size={kib}k");
        let resized = Command::new("mount").args(["-o", &size]).arg(self.path).status();
        assert!(resized.expect("mount").success());
    }
}

impl Drop for SmallDisk<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.path).status();
    }
}

#[test]
fn a_full_file_system_loses_no_acknowledged_change() {
    let folder = folder();
    let reference = reference(&folder.path().join("reference"));
    let place = folder.path().join("disk");
    fs::create_dir(&place).expect("a folder");
    let mut stopped = BTreeSet::new();
    for kib in (160..).step_by(52) {
        let Some(disk) = SmallDisk::mount(&place, kib) else { return };
        let path = place.join("store");
        let started = Store::create(&path, &by("lead", 0));
        let Ok(mut store) = started else {
            let refused = started.expect_err("no room");
            assert!(
                matches!(refused, StoreError::Full | StoreError::Disk { .. }),
                "{kib}: {refused:?}"
            );
            continue;
        };
        let outcome = (0..STEPS).try_for_each(|step| run(&mut store, step).map_err(|e| (step, e)));
        let Err((step, error)) = outcome else { break };
        assert!(
            matches!(error, StoreError::Full | StoreError::Disk { .. }),
            "{kib} KiB: {error:?}"
        );
        stopped.insert(step);
        match try_fingerprint(&store) {
            Ok(print) => assert_eq!(print, reference[step], "{kib} KiB, step {step}"),
            // The index beside the log finds no room either: even reading a new store fails until there is room.
            Err(error) => {
                assert!(step == 0 && matches!(error, StoreError::Disk { .. }), "{kib}: {error:?}");
            }
        }
        disk.resize(100_000);
        (step..STEPS).for_each(|rest| run(&mut store, rest).expect("there is room now"));
        assert_eq!(fingerprint(&store), reference[STEPS]);
        assert!(store.verify(None).expect("verifiable").is_clean());
        drop((store, disk));
    }
    assert!(stopped.len() > 3, "stopped at {stopped:?} only");
    println!("stopped at {stopped:?}");
}

#[test]
fn a_backup_without_room_is_refused_and_leaves_no_file() {
    let (folder, store) = folder_with_store(STEPS);
    let place = folder.path().join("disk");
    fs::create_dir(&place).expect("a folder");
    let Some(disk) = SmallDisk::mount(&place, 60) else { return };
    refused!(store.backup_to(&place.join("copy")), Full | StoreError::Disk { .. });
    assert_eq!(fs::read_dir(&place).expect("a folder").count(), 0);
    disk.resize(100_000);
    assert!(store.backup_to(&place.join("copy")).expect("room").is_clean());
}

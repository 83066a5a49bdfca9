//! Seeds, and inputs that once failed, hold now.

use std::path::Path;

#[test]
fn seeds_and_regressions_hold() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (target, check) in ocellus_fuzz::CHECKS {
        let mut inputs = 0;
        for folder in ["seeds", "regressions"] {
            // Where nothing ever failed there is no folder.
            let Ok(entries) = root.join(folder).join(target).read_dir() else { continue };
            for entry in entries {
                let path = entry.expect("an entry").path();
                println!("{}", path.display());
                check(&std::fs::read(&path).expect("an input"));
                inputs += 1;
            }
        }
        assert!(inputs > 0, "{target} has no seeds");
    }
}

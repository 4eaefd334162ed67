//! `docs/reference/dependencies.md` against the manifests.

use std::collections::BTreeSet;

use crate::workspace::Package;

/// One use of a foreign crate: `(crate, package, only by its tests)`.
pub(crate) type Use = (String, String, bool);

/// The uses the manifests declare. Where a package has a crate both in the product and in its tests, the product counts.
pub(crate) fn declared(packages: &[Package]) -> BTreeSet<Use> {
    let mut uses = BTreeSet::new();
    for package in packages {
        let in_product = |name: &str| package.dependencies.iter().any(|used| used.name == name && !used.dev);
        for dependency in package.dependencies.iter().filter(|dependency| !dependency.ours) {
            uses.insert((dependency.name.clone(), package.name.clone(), !in_product(&dependency.name)));
        }
    }
    uses
}

/// The uses the document lists: rows such as ``| `serde` | `softlimb`, `protocol` (tests) | why | not chosen |``.
pub(crate) fn documented(document: &str) -> Result<BTreeSet<Use>, String> {
    let mut uses = BTreeSet::new();
    for row in document.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        let [name, users, why, others] = cells[..] else { return Err(format!("not four cells: {row}")) };
        if why.is_empty() || others.is_empty() {
            return Err(format!("an empty cell: {row}"));
        }
        for user in users.split(',').map(str::trim) {
            let (package, dev) = match user.strip_suffix("(tests)") {
                Some(package) => (package, true),
                None => (user, false),
            };
            if !uses.insert((bare(name), bare(package), dev)) {
                return Err(format!("listed twice: {row}"));
            }
        }
    }
    Ok(uses)
}

fn bare(cell: &str) -> String {
    cell.trim().trim_matches('`').to_owned()
}

#[test]
fn rows_are_read_and_poor_ones_refused() {
    let uses = documented("text\n| crate | x |\n| `crc` | `protocol`, `host` (tests) | sums | own table |\n").unwrap();
    let expected = [("crc", "host", true), ("crc", "protocol", false)];
    assert_eq!(uses, expected.map(|(a, b, c)| (a.to_owned(), b.to_owned(), c)).into());
    assert!(documented("| `crc` | `host` | |  |\n").is_err());
    assert!(documented("| `crc` | `host` | sums |\n").is_err());
    assert!(documented("| `crc` | `host`, `host` | sums | own |\n").is_err());
}

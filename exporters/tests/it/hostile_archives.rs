//! Reports on malicious archives; nothing in them is trusted.

use std::io::Write;

use crate::forge;
use forge::{Forged, amend, package_of, tar, verdict, zip, zstd};
use plume_exporters::package::MANIFEST;
use tar::{EntryType, Header};
use zip::write::SimpleFileOptions;

/// A small, intact package.
fn innocent() -> Forged {
    package_of(&[("README.md", b"# A cave\n"), ("notes.txt", b"Mind your head.\n")])
}

/// The report on a zip with an additional entry.
fn with_entry(name: &str) -> String {
    verdict(&zip(&innocent(), |zip| {
        zip.start_file(name, SimpleFileOptions::default()).unwrap();
        zip.write_all(b"evil").unwrap();
    }))
}

/// The bytes with all occurrences of a text replaced by another of the same length.
fn replaced(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut replaced = bytes.to_vec();
    for at in (0..=bytes.len() - from.len()).filter(|&at| bytes[at..].starts_with(from)) {
        replaced[at..at + from.len()].copy_from_slice(to);
    }
    assert_ne!(replaced, bytes);
    replaced
}

#[test]
fn names_that_lead_outside_a_zip_are_reported() {
    assert_eq!(verdict(&zip(&innocent(), |_| ())), "whole");
    let names = ["../evil", "a/../../evil", "/etc/evil", "c:/evil", "a\\evil", "a//evil", "more.txt"];
    insta::assert_snapshot!(names.map(with_entry).join("\n"), @r"
    ../evil: has an empty, `.` or `..` part
    a/../../evil: has an empty, `.` or `..` part
    /etc/evil: is not relative with forward slashes
    c:/evil: is not relative with forward slashes
    a\evil: is not relative with forward slashes
    a//evil: has an empty, `.` or `..` part
    more.txt: is not in the manifest
    ");
    let with_odd_name = zip(&innocent(), |zip| zip.start_file("caf_.txt", SimpleFileOptions::default()).unwrap());
    insta::assert_snapshot!(verdict(&replaced(&with_odd_name, b"caf_", b"caf\xe9")), @"caf�.txt: has a name that is not UTF-8");
}

#[test]
fn special_entries_of_a_zip_are_reported() {
    let link = zip(&innocent(), |zip| {
        zip.add_symlink("link", "/etc/passwd", SimpleFileOptions::default()).unwrap();
    });
    insta::assert_snapshot!(verdict(&link), @"link: is a link");
    let twice = zip(&innocent(), |zip| zip.start_file("READMY.md", SimpleFileOptions::default()).unwrap());
    insta::assert_snapshot!(verdict(&replaced(&twice, b"READMY.md", b"README.md")), @r"
    .: is inconsistent: invalid Zip archive: header inconsistency detected: duplicate file names in central directory
    README.md: has 0 bytes, not the 9 recorded in the manifest
    ");
}

#[test]
fn an_inconsistent_zip_is_reported() {
    let whole = zip(&innocent(), |_| ());
    insta::assert_snapshot!(verdict(&[b"PK=1; exec sh\n", &whole[..]].concat()), @".: begins with data that does not belong to the zip");
    let local = whole.windows(9).position(|name| name == b"notes.txt").unwrap();
    let mut other_name = whole.clone();
    other_name[local] = b'v';
    insta::assert_snapshot!(verdict(&other_name), @".: is inconsistent: invalid Zip archive: header inconsistency detected: Local file header filename mismatch (does not match central directory)");
    insta::assert_snapshot!(verdict(&whole[..whole.len() / 2]), @".: cannot be read: invalid Zip archive: Could not find EOCD");
    insta::assert_snapshot!(verdict(b"PK"), @".: cannot be read: invalid Zip archive: Could not find EOCD");
}

#[test]
fn trailing_data_after_a_zip_is_reported() {
    let whole = zip(&innocent(), |_| ());
    let commented = zip(&innocent(), |zip| zip.set_comment("rm -rf").unwrap());
    // The comment contains another end record, according to which there is no comment.
    let mut twice = whole.clone();
    let end = whole[whole.len() - 22..].to_vec();
    *twice.iter_mut().rev().nth(1).unwrap() = 22;
    twice.extend(end);
    let said = [&[&whole[..], b"more"].concat(), &[&whole[..], &[0; 40]].concat(), &commented, &twice];
    insta::assert_snapshot!(said.map(|archive| verdict(archive)).join("\n"), @r"
    .: has trailing data or a comment
    .: has trailing data or a comment
    .: has trailing data or a comment
    .: has trailing data or a comment
    ");
}

#[test]
fn device_names_are_reported() {
    insta::assert_snapshot!(["nul", "a/CON.txt", "console"].map(with_entry).join("\n"), @r"
    nul: has a part that is a device name on Windows
    a/CON.txt: has a part that is a device name on Windows
    console: is not in the manifest
    ");
}

#[test]
fn a_zip_with_wrong_sizes_is_reported() {
    let mut bomb = innocent();
    bomb.insert("notes.txt".to_owned(), vec![0; 32 << 20]);
    insta::assert_snapshot!(verdict(&zip(&bomb, |_| ())), @"notes.txt: has more than the 16 bytes recorded in the manifest");
    // The headers agree with the manifest, but the stream is longer.
    let sizes = [(32_u32 << 20).to_le_bytes(), 16_u32.to_le_bytes()];
    let lying = replaced(&zip(&bomb, |_| ()), &sizes[0], &sizes[1]);
    insta::assert_snapshot!(verdict(&lying), @"notes.txt: cannot be read: File is larger than its declared uncompressed size");
    // A manifest may claim any size.
    amend(&mut bomb, |manifest| manifest.files.0.get_mut("notes.txt").unwrap().bytes = u64::MAX);
    insta::assert_snapshot!(verdict(&zip(&bomb, |_| ())), @"notes.txt: cannot be read: unpacks to an implausible size");
}

fn header(name: &str, kind: EntryType, size: u64) -> Header {
    let mut header = Header::new_ustar();
    header.as_ustar_mut().unwrap().name[..name.len()].copy_from_slice(name.as_bytes());
    header.set_entry_type(kind);
    header.set_size(size);
    header.set_cksum();
    header
}

/// The report on a tar with an additional entry.
fn with_tar_entry(name: &str, kind: EntryType) -> String {
    let tar = tar(&innocent(), |tar| tar.append(&header(name, kind, 0), &b""[..]).unwrap());
    verdict(&zstd(&tar))
}

#[test]
fn special_entries_of_a_tar_are_reported() {
    assert_eq!(verdict(&zstd(&tar(&innocent(), |_| ()))), "whole");
    let entries = [
        ("../evil", EntryType::Regular),
        ("/etc/evil", EntryType::Regular),
        ("folder/", EntryType::Directory),
        ("link", EntryType::Symlink),
        ("hard", EntryType::Link),
        ("pipe", EntryType::Fifo),
        ("disk", EntryType::Block),
        ("tty", EntryType::Char),
        ("long", EntryType::GNULongName),
        ("head", EntryType::XHeader),
        ("holes", EntryType::GNUSparse),
        ("README.md", EntryType::Regular),
        ("more.txt", EntryType::Regular),
    ];
    let said = entries.map(|(name, kind)| with_tar_entry(name, kind));
    insta::assert_snapshot!(said.join("\n"), @r"
    ../evil: has an empty, `.` or `..` part
    /etc/evil: is not relative with forward slashes
    whole
    link: is a link
    hard: is a link
    pipe: is not a file or folder but has the tar type Fifo
    disk: is not a file or folder but has the tar type Block
    tty: is not a file or folder but has the tar type Char
    long: is not a file or folder but has the tar type GNULongName
    head: is not a file or folder but has the tar type XHeader
    holes: is not a file or folder but has the tar type GNUSparse
    README.md: appears twice
    more.txt: is not in the manifest
    ");
}

#[test]
fn a_damaged_tar_is_reported() {
    let whole = zstd(&tar(&innocent(), |_| ()));
    insta::assert_snapshot!(verdict(&whole[..whole.len() / 2]), @".: cannot be read: incomplete frame");
    insta::assert_snapshot!(verdict(&[&whole[..], b"more"].concat()), @".: has trailing data");
    let hidden = [tar(&innocent(), |_| ()), tar(&Forged::from([("evil".to_owned(), Vec::new())]), |_| ())].concat();
    insta::assert_snapshot!(verdict(&zstd(&hidden)), @".: has trailing data");
    // A skippable frame may contain anything.
    let skipped = [&whole[..], &[0x50, 0x2a, 0x4d, 0x18, 4, 0, 0, 0], b"evil"].concat();
    insta::assert_snapshot!(verdict(&skipped), @".: has trailing data");
    let packed = |bytes: &[u8]| {
        let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        gzip.write_all(bytes).unwrap();
        gzip.finish().unwrap()
    };
    let below: Forged = innocent().into_iter().map(|(path, bytes)| (format!("package/{path}"), bytes)).collect();
    let whole = packed(&tar(&below, |_| ()));
    let said = [
        &whole,
        &[&whole[..], b"more"].concat(),
        &[&whole[..], &[0; 40]].concat(),
        &[&whole[..], &packed(b"")].concat(),
    ];
    insta::assert_snapshot!(said.map(|archive| verdict(archive)).join("\n"), @r"
    whole
    .: has trailing data
    .: has trailing data
    .: has trailing data
    ");
    let bomb = tar(&innocent(), |tar| {
        let size = 64 << 20;
        tar.append(&header("zeros", EntryType::Regular, size), std::io::Read::take(std::io::repeat(0), size)).unwrap();
    });
    insta::assert_snapshot!(verdict(&zstd(&bomb)), @r"
    .: cannot be read: unpacks to an implausible size
    zeros: is not in the manifest
    ");
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(&tar(&innocent(), |_| ())).unwrap();
    insta::assert_snapshot!(verdict(&gzip.finish().unwrap()), @"ARCHIVE: contains no package manifest");
}

#[test]
fn invalid_paths_in_a_manifest_are_reported() {
    let mut wild = innocent();
    amend(&mut wild, |manifest| {
        for path in ["../../etc/passwd", "/etc/shadow", "a//b"] {
            manifest.files.0.insert(path.to_owned(), forge::entry(b"root"));
        }
        manifest.chunks[0].textures.insert("normal".to_owned(), "/dev/zero".to_owned());
        manifest.chunks[1].neighbors = vec!["nowhere".to_owned()];
    });
    insta::assert_snapshot!(verdict(&zip(&wild, |_| ())), @r"
    ../../etc/passwd: is missing
    /etc/shadow: is missing
    a//b: is missing
    manifest.json: lists `../../etc/passwd`, which has an empty, `.` or `..` part
    manifest.json: lists `/etc/shadow`, which is not relative with forward slashes
    manifest.json: lists `a//b`, which has an empty, `.` or `..` part
    manifest.json: lists `chunk_1_0_0` as a neighbour of chunk `chunk_0_0_0`, but not the other way round
    manifest.json: lists `nowhere` as a neighbour of chunk `chunk_1_0_0`, but not the other way round
    manifest.json: lists chunk `chunk_0_0_0` with the image `/dev/zero`, but not that file
    ");
}

#[test]
fn other_versions_and_other_files_are_reported() {
    let text = |text: &str| zip(&Forged::from([(MANIFEST.to_owned(), text.as_bytes().to_vec())]), |_| ());
    let newer = r#"{"format": 4, "generator": "plume 9.1.0", "target": "gltf", "files": {}, "moons": 2}"#;
    let said = [
        verdict(&text(newer)),
        verdict(&text(r#"{"a.txt": {"bytes": 1, "sha256": "0"}}"#)),
        verdict(&text(r#"{"name": "of a browser"}"#)),
        verdict(&text("no JSON")),
        verdict(&zip(&Forged::from([("a.txt".to_owned(), Vec::new())]), |_| ())),
        verdict(b"dear diary"),
        verdict(b""),
    ];
    insta::assert_snapshot!(said.join("\n"), @r"
    ARCHIVE: this package was made by plume 9.1.0; its manifest has format 4, this program supports 3
    ARCHIVE: this package was made by an earlier version, whose manifest lacks what a check needs
    ARCHIVE: contains no package manifest
    ARCHIVE: contains no package manifest
    ARCHIVE: contains no package manifest
    ARCHIVE: is not a folder, zip, tar.zst or tgz
    ARCHIVE: is not a folder, zip, tar.zst or tgz
    ");
}

#[cfg(unix)]
#[test]
fn links_in_a_folder_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    for (path, bytes) in innocent() {
        std::fs::write(folder.path().join(path), bytes).unwrap();
    }
    std::os::unix::fs::symlink("/etc/passwd", folder.path().join("link")).unwrap();
    std::fs::rename(folder.path().join("notes.txt"), folder.path().join("elsewhere")).unwrap();
    std::os::unix::fs::symlink("elsewhere", folder.path().join("notes.txt")).unwrap();
    insta::assert_snapshot!(forge::told(folder.path()), @r"
    elsewhere: is not in the manifest
    link: is a link
    notes.txt: is a link
    notes.txt: is missing
    ");
}

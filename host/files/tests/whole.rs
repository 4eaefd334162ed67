//! Files that are written whole, whatever is in their place.

use std::fs;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::Path;
use std::process::Command;

use softlimb_files::write_whole;

#[test]
fn file_that_cannot_be_written_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("there");
    fs::create_dir(&place).unwrap();
    let text = write_whole(&place, "text").unwrap_err().to_string();
    assert!(text.contains("cannot write") && text.contains("there"), "{text}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "a part is left");
}

#[test]
fn link_stays_a_link_to_the_file_that_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("elsewhere")).unwrap();
    fs::write(at("elsewhere/there"), "before").unwrap();
    for name in ["there", "not yet"] {
        symlink(Path::new("elsewhere").join(name), at("first")).unwrap();
        symlink("first", at("second")).unwrap();
        write_whole(&at("second"), "text").unwrap();
        for link in ["first", "second"] {
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
            fs::remove_file(at(link)).unwrap();
        }
        assert_eq!(fs::read_to_string(at("elsewhere").join(name)).unwrap(), "text");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(fs::read_dir(at("elsewhere")).unwrap().count(), 2, "a part is left");
    symlink("round", at("round")).unwrap();
    assert!(write_whole(&at("round"), "text").is_err());
}

#[test]
fn pipe_gets_the_text_and_stays_a_pipe() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).unwrap()
    });
    write_whole(&pipe, "text").unwrap();
    assert_eq!(reader.join().unwrap(), "text");
    assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
    write_whole(Path::new("/dev/null"), "text").unwrap();
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
}

//! Campaigns in folders, and what is said of wrong ones.

use super::super::mapping::Mapping;
use super::*;
use crate::signal::Channel;

const SIDECAR: &str = "layout = \"lines/b.lss\"\nsensor_cart = 1\nspeed_setpoint = 2\ntrigger_position = 0\n\
                       lowpass = 100\nlaps = 1\n";

/// A folder with these files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
        fs::write(path, text).expect("written");
    }
    folder
}

fn told(folder: &tempfile::TempDir) -> String {
    let error = Campaign::read(folder.path()).expect_err("a mistake").to_string();
    error.replace(&format!("{}{}", folder.path().display(), std::path::MAIN_SEPARATOR), "")
}

#[test]
fn runs_take_their_layout_from_the_entry_the_campaign_or_the_sidecar() {
    let list = "[[run]]\nfile = \"one.csv\"\nlayout = \"a.lss\"\nspeed = 2\ntension = 1e3\n\n[[run]]\n\
                file = \"sub/two.parquet\"\n";
    let files =
        [("campaign.toml", list), ("one.csv", ""), ("sub/two.parquet", ""), ("sub/two.toml", SIDECAR), ("c.csv", "")];
    let at = folder(&files);
    let mut campaign = Campaign::read(at.path()).expect("a campaign");
    let entry = |name: &str, file: &str, layout: &str, nominal: Option<(f64, f64)>| Entry {
        name: name.to_owned(),
        file: at.path().join(file),
        root: Root::of_campaign(at.path()),
        layout: at.path().join(layout),
        speed: nominal.map(|n| n.0),
        tension: nominal.map(|n| n.1),
        settings: BTreeMap::new(),
        defaults: SidecarDefaults::default(),
    };
    let one = entry("one", "one.csv", "a.lss", Some((2.0, 1000.0)));
    assert_eq!(campaign.runs, [one.clone(), entry("two", "sub/two.parquet", "sub/lines/b.lss", None)]);
    let named = Campaign::read(&at.path().join("campaign.toml")).expect("a campaign");
    campaign.root.clone_from(&named.root);
    campaign.runs.iter_mut().for_each(|run| run.root.clone_from(&named.root));
    assert_eq!(named, campaign, "the file names its folder");
    fs::write(at.path().join("campaign.toml"), format!("layout = \"d.lss\"\n{list}")).expect("written");
    let campaign = Campaign::read(at.path()).expect("a campaign");
    assert_eq!(campaign.runs, [one, entry("two", "sub/two.parquet", "d.lss", None)]);
}

/// What the runs of one recorder have in common is said once; a sidecar that says it has the last word.
#[test]
fn a_campaign_says_what_its_recorder_did() {
    let list = "zeroed = [\"run_left\"]\n[columns]\n\"Zug [kN]\" = { channel = \"joint_xi\", factor = 1000 }\n\
                [[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"b.csv\"\n";
    let data = "time,trigger,Zug [kN]\n0,0,1\n0.002,1,2\n0.004,0,3\n";
    let own = format!("{SIDECAR}zeroed = []\n[columns]\n\"Zug [kN]\" = {{ channel = \"joint_xi\", factor = 1 }}\n");
    let at =
        folder(&[("campaign.toml", list), ("a.csv", data), ("a.toml", SIDECAR), ("b.csv", data), ("b.toml", &own)]);
    let campaign = Campaign::read(at.path()).expect("a campaign");
    let [a, b] = [0, 1].map(|k| campaign.runs[k].run().expect("a run"));
    let forces = |run: &Run| run.channels[&Channel::JointXi].clone();
    assert_eq!((forces(&a), forces(&b)), (vec![1000.0, 2000.0, 3000.0], vec![1.0, 2.0, 3.0]));
    assert_eq!((a.sidecar.zeroed, b.sidecar.zeroed), (vec![Channel::RunLeft], Vec::new()));
    // A mistake is told where it stands.
    let wrong = list.replace("joint_xi", "joint_x");
    fs::write(at.path().join("campaign.toml"), wrong).expect("written");
    let said = Campaign::read(at.path()).expect_err("no channel").to_string();
    assert!(said.contains("campaign.toml") && said.contains("Zug [kN]") && said.contains(Mapping::ENTRY), "{said}");
}

#[test]
fn a_folder_alone_is_a_campaign_of_the_runs_with_sidecars() {
    let files =
        [("b.csv", ""), ("b.toml", SIDECAR), ("a.MF4", ""), ("a.toml", SIDECAR), ("bill.csv", ""), ("n.txt", "")];
    let at = folder(&files);
    let campaign = Campaign::read(at.path()).expect("a campaign");
    assert_eq!(campaign.runs.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["a", "b"]);
    assert_eq!(campaign.runs[1].layout, at.path().join("lines/b.lss"));
    let mut single = Campaign::read(&at.path().join("b.csv")).expect("a campaign");
    single.runs[0].root.clone_from(&campaign.root);
    assert_eq!(single.runs, campaign.runs[1..]);
}

#[test]
fn a_run_alone_is_as_the_campaign_beside_it_lists_it() {
    let list = "layout = \"d.lss\"\nzeroed = [\"run_left\"]\n[[run]]\nfile = \"./a.csv\"\nspeed = 2\ntension = 700\n";
    let data = "time,trigger,run_left\n0,0,1\n0.002,1,2\n0.004,0,3\n";
    let files = [("campaign.toml", list), ("a.csv", data), ("a.toml", SIDECAR), ("b.csv", data), ("b.toml", SIDECAR)];
    let at = folder(&files);
    let [a, b] = ["a.csv", "b.csv"].map(|name| Entry::of(&at.path().join(name)).expect("a run"));
    assert_eq!((a.layout.clone(), a.speed, a.tension), (at.path().join("d.lss"), Some(2.0), Some(700.0)));
    assert_eq!(a.run().expect("samples").sidecar.zeroed, [Channel::RunLeft]);
    assert_eq!((b.layout.clone(), b.tension), (at.path().join("lines/b.lss"), None));
    assert_eq!(b.run().expect("samples").sidecar.zeroed, []);
    assert!(matches!(Entry::of(&at.path().join("a.toml")).expect_err("no data").problem, DataProblem::UnknownFormat));
}

#[test]
fn another_machine_declares_its_channels_and_needs_no_layout() {
    let list = "[[run]]\nfile = \"one.csv\"\npayload = 20\n[channels]\nposition = \"m\"\nforce = \"N\"\n";
    let campaign = Campaign::read(folder(&[("campaign.toml", list), ("one.csv", "")]).path()).expect("a campaign");
    assert_eq!(campaign.channels, [("force", "N"), ("position", "m")].map(|(a, b)| (a.into(), b.into())).into());
    assert_eq!(campaign.runs[0].layout, PathBuf::new());
    assert_eq!(campaign.runs[0].settings, [("payload".to_owned(), 20.0)].into());
}

#[test]
fn mistakes_are_told_with_their_line_and_a_way_out() {
    let run = "[[run]]\nfile = \"one.csv\"\n";
    let cases = [
        (String::new(), "campaign.toml: the campaign has no runs\n  help: add [[run]] with file"),
        (
            format!("# all\nlayuot = \"a\"\n{run}"),
            "campaign.toml, row 2, `layuot`: there is no such key\n  help: did you mean `layout`?",
        ),
        (
            format!("{run}weather = \"dry\""),
            "campaign.toml, row 3, `weather`: there is no such key\n  \
             help: remove it; keys are file, layout, speed, tension",
        ),
        ("run = 3".into(), "campaign.toml, row 1, `run`: the value is not tables, each headed by [[run]]"),
        ("run = [3]".into(), "campaign.toml, row 1, `run`: the value is not tables, each headed by [[run]]"),
        ("channels = 3".into(), "campaign.toml, row 1, `channels`: the value is not a table headed by [channels]"),
        ("[channels]\nx = 3".into(), "campaign.toml, row 2, `x`: the value is not a unit in quotes"),
        (format!("{run}speed = 0"), "campaign.toml, row 3, `speed`: the value is not a speed above 0"),
        (format!("{run}tension = \"1 kN\""), "campaign.toml, row 3, `tension`: the value is not a force from 0"),
        (
            format!("{run}\n[[run]]\nspeed = 2"),
            "campaign.toml, row 4, `file`: the key is missing\n  help: add file = \"run-01.csv\", the path",
        ),
        (
            format!("{run}layout = \"a.lss\"\n{}", run.replace("one", "none")),
            "campaign.toml, row 5, `file`: there is no file none.csv\n  \
             help: paths are seen from the campaign's folder",
        ),
        (
            format!("layout = \"a.lss\"\n{run}{run}"),
            "campaign.toml, row 5, `file`: the run has the same name as one.csv\n  \
             help: a run is known by its file's name",
        ),
        (run.to_owned(), "one.csv: there is no sidecar one.toml\n  help: write it with layout"),
        ("[[run]\n".into(), "campaign.toml, row 1: is malformed: "),
    ];
    for (list, expected) in cases {
        let told = told(&folder(&[("campaign.toml", &list), ("one.csv", "")]));
        assert!(told.starts_with(expected), "{list}\n{told}\n{expected}");
    }
    let twice = folder(&[("one.csv", ""), ("one.parquet", ""), ("one.toml", SIDECAR)]);
    assert!(told(&twice).starts_with("one.parquet: the run has the same name as one.csv"), "{}", told(&twice));
    assert!(told(&folder(&[("note.txt", "")])).contains(": the campaign has no runs"));
    let lonely = told(&folder(&[("bom.csv", ""), ("run-01.csv", "")]));
    assert!(lonely.starts_with("run-01.csv: there is no sidecar run-01.toml"), "{lonely}");
    assert!(Campaign::read(Path::new("no/such/folder")).expect_err("nothing").is_unreadable());
}

#[test]
fn a_bad_run_does_not_hide_the_good_ones() {
    let files = [("a.csv", ""), ("a.toml", "laps = 1"), ("b.csv", ""), ("b.toml", SIDECAR)];
    let (campaign, refused) = Campaign::read_each(folder(&files).path()).expect("a campaign");
    assert_eq!((campaign.runs[0].name.as_str(), refused[0].name.as_str()), ("b", "a"));
    assert_eq!(refused[0].error.problem, DataProblem::MissingKey);
}

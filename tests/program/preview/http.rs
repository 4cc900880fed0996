//! Who is answered, and what is written.

use super::client::{HALL, Preview, optimised};
use serde_json::{Value, json};
use std::fs;

/// What lies beside the project and must not be said.
const SECRET: &str = "hunter2_s3cr3t";

#[test]
fn only_who_knows_the_address_is_answered() {
    let preview = Preview::new(HALL);
    assert_eq!(preview.get(&preview.path).status, 200);
    let token = preview.path.trim_matches('/');
    assert_eq!(token.len(), 32);
    let near = format!("{}0", &token[..31]);
    for path in
        ["/", "/state?after=0", "/page.js", "/favicon.ico", &format!("/{near}/"), &format!("/{}/", &token[..31])]
    {
        if path != preview.path {
            let answer = preview.get(path);
            assert_eq!(answer.status, 404, "{path}");
            assert!(!answer.body.contains("hall") && !answer.body.contains(token), "{}", answer.body);
        }
    }
    let asked = |host: &str, more: &str| {
        preview.raw(&format!("GET {}state?after=0 HTTP/1.0\r\nHost: {host}\r\n{more}\r\n", preview.path)).status
    };
    let here = format!("127.0.0.1:{}", preview.port);
    assert_eq!(asked(&here, ""), 200);
    assert_eq!(asked(&here, &format!("Origin: http://{here}\r\n")), 200);
    assert_eq!(asked(&format!("localhost:{}", preview.port), ""), 200);
    for host in ["evil.example", &format!("evil.example:{}", preview.port), "127.0.0.1", "127.0.0.1:1", ""] {
        assert_eq!(asked(host, ""), 403, "{host}");
    }
    for origin in ["http://evil.example", "null", &format!("https://{here}"), "http://127.0.0.1"] {
        assert_eq!(asked(&here, &format!("Origin: {origin}\r\n")), 403, "{origin}");
    }
    // What changes something needs to come from the page itself.
    let body = preview.placed(1, 36.0, 4.0);
    for origin in ["", "Origin: http://evil.example\r\n"] {
        let request = format!(
            "POST {}put HTTP/1.0\r\nHost: {here}\r\n{origin}Content-Length: {}\r\n\r\n{body}",
            preview.path,
            body.len()
        );
        assert_eq!(preview.raw(&request).status, 403, "{origin}");
    }
    assert_eq!(preview.text(), HALL);
}

#[test]
fn no_address_is_the_name_of_a_file() {
    let preview = Preview::new(HALL);
    fs::write(preview.folder.path().join("secret.lss"), SECRET).unwrap();
    for rest in [
        "hall.lss",
        "secret.lss",
        "./secret.lss",
        "../secret.lss",
        "..%2fsecret.lss",
        "%2e%2e/%2e%2e/etc/passwd",
        "../../../../../../etc/passwd",
        "/etc/passwd",
        "state/../secret.lss",
        "page.js/../secret.lss",
        "state?after=../secret.lss",
        "\\..\\secret.lss",
    ] {
        let answer = preview.get(&format!("{}{rest}", preview.path));
        let is_state = rest.starts_with("state?");
        assert_eq!(answer.status, if is_state { 200 } else { 404 }, "{rest}");
        assert!(!answer.body.contains(SECRET) && !answer.body.contains("root:"), "{rest}: {}", answer.body);
    }
}

#[test]
fn imports_from_outside_the_project_are_not_shown() {
    let outside = tempfile::tempdir().unwrap();
    fs::write(outside.path().join("words.lss"), format!("{SECRET} = 1\n")).unwrap();
    let place = outside.path().join("words.lss").canonicalize().unwrap();
    let preview = Preview::new(HALL);
    for named in [place.to_string_lossy().into_owned(), format!("../../..{}", place.to_string_lossy())] {
        preview.save(&format!("use \"{named}\"\n{HALL}"));
        let parts = preview.until("the refusal", |parts| parts["errors"].as_str().is_some_and(|e| e.contains(&named)));
        assert!(parts["errors"].as_str().unwrap().contains("E0203"), "{parts}");
        assert!(!parts.to_string().contains(SECRET));
        preview.save(HALL);
        preview
            .until("no error", |parts| parts["errors"].as_str().is_some_and(|e| !e.contains("article class=\"error")));
    }
}

/// Every answer, refusals too, says what a page may do.
#[test]
fn answers_allow_a_page_nothing_but_this_server() {
    let preview = Preview::new(HALL);
    let path = &preview.path;
    for path in [path.clone(), format!("{path}page.js"), format!("{path}page.css"), "/".to_owned()] {
        let headers = preview.get(&path).headers;
        for wanted in [
            "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self';",
            "frame-ancestors 'none'",
            "X-Content-Type-Options: nosniff",
            "Referrer-Policy: no-referrer",
            "Cache-Control: no-store",
            "Cross-Origin-Resource-Policy: same-origin",
        ] {
            assert!(headers.contains(wanted), "{path}: {wanted}\n{headers}");
        }
        assert!(!headers.contains("Access-Control-Allow"), "{headers}");
    }
    let page = preview.get(path).body;
    assert!(!page.contains("<script>") && !page.contains("style=") && !page.contains("://"), "{page}");
}

/// As the system has it: the one socket that listens on the port.
#[cfg(target_os = "linux")]
#[test]
fn it_listens_on_the_loopback_only() {
    let preview = Preview::new(HALL);
    let (mut found, port) = (Vec::new(), format!(":{:04X}", preview.port));
    for table in ["/proc/net/tcp", "/proc/net/tcp6"] {
        for line in fs::read_to_string(table).unwrap_or_default().lines().skip(1) {
            let mut columns = line.split_whitespace().skip(1);
            let (local, _, state) = (columns.next().unwrap(), columns.next().unwrap(), columns.next().unwrap());
            if local.ends_with(&port) && state == "0A" {
                found.push(local.to_owned());
            }
        }
    }
    assert_eq!(found, [format!("0100007F{port}")]);
}

#[test]
fn a_vertex_is_written_into_its_line_and_nowhere_else() {
    let preview = Preview::new(HALL);
    let parts = preview.until_solved();
    let vertices = parts["plan"]["vertices"].as_array().unwrap();
    assert_eq!(vertices[1]["moves"], json!({ "x": true, "y": true }));
    assert_eq!(
        (&vertices[2]["moves"], &vertices[2]["why"]),
        (&json!({ "x": false, "y": true }), &json!("a formula gives its x"))
    );
    assert_eq!(vertices[1]["line"], 14);
    assert_eq!(preview.post("put", &preview.placed(1, 35.25, 4.5)).json()["problem"], Value::Null);
    let first = HALL.replace("(37.0 m ,  3000 mm)", "(35.25 m ,  4500 mm)");
    assert_eq!(preview.text(), first);
    let parts = preview.until_solved();
    assert_eq!((&parts["plan"]["vertices"][1]["x"], &parts["plan"]["vertices"][1]["y"]), (&json!(35.25), &json!(4.5)));
    assert_eq!(parts["history"], json!({ "undo": 1, "redo": 0 }));
    // Where a formula gives a coordinate, the other one is written.
    assert_eq!(preview.post("put", &preview.placed(2, 30.0, 16.0)).status, 200);
    let second = first.replace("(far, 17 m)", "(far, 16 m)");
    assert_eq!(preview.text(), second);
    for (what, text) in [("undo", &first), ("undo", &HALL.to_owned()), ("redo", &first), ("redo", &second)] {
        assert_eq!(preview.post(what, "{}").status, 200);
        assert_eq!(&preview.text(), text, "{what}");
    }
    assert_eq!(preview.post("redo", "{}").json()["problem"], "there is nothing to redo");
}

#[test]
fn nothing_is_written_over_a_file_that_changed() {
    let preview = Preview::new(HALL);
    preview.until_solved();
    let placed = preview.placed(1, 35.0, 4.0);
    let edited = HALL.replace("// A hall.", "// Another hall.");
    preview.save(&edited);
    // Whether the change was seen already or not.
    let answer = preview.post("put", &placed);
    assert_eq!((answer.status, answer.json()["problem"].as_str().unwrap().contains("changed meanwhile")), (409, true));
    assert_eq!(preview.text(), edited);
    preview.until_solved();
    assert_eq!(preview.post("put", &placed).status, 409);
    // Nor is a change taken back that somebody built upon.
    assert_eq!(preview.post("put", &preview.placed(1, 35.0, 4.0)).status, 200);
    let upon = preview.text().replace("Another", "A third");
    preview.save(&upon);
    assert_eq!(preview.post("undo", "{}").status, 409);
    assert_eq!(preview.text(), upon);
}

#[test]
fn what_is_no_request_of_the_page_changes_nothing() {
    let preview = Preview::new(HALL);
    preview.until_solved();
    let text = preview.parts()["plan"]["text"].clone();
    let placed =
        |vertex: &str, x: &str, more: &str| format!("{{\"vertex\":{vertex},\"x\":{x},\"y\":1,\"text\":{text}{more}}}");
    for body in [
        String::new(),
        "{".into(),
        "[]".into(),
        placed("9", "1", ""),
        placed("-1", "1", ""),
        placed("1", "1e9", ""),
        placed("1", "null", ""),
        placed("1", "\"1 m, 1 m) // \"", ""),
        placed("1", "1", ",\"file\":\"secret.lss\""),
        "[".repeat(3000),
    ] {
        assert_eq!(preview.post("put", &body).status, 409, "{body}");
        preview.post("move", &body);
    }
    assert_eq!(preview.post("put", &" ".repeat(5000)).status, 413);
    assert_eq!(preview.get(&format!("{}put", preview.path)).status, 404);
    assert_eq!(preview.text(), HALL);
    assert_eq!(preview.until_solved()["plan"]["name"], "hall");
}

#[test]
fn mistakes_are_shown_beside_the_last_drawing() {
    let preview = Preview::new(HALL);
    let before = preview.until_solved();
    preview.save(&HALL.replace("speed 2.0", "sped 2.0"));
    let parts = preview.until("the mistake", |parts| parts["errors"].as_str().is_some_and(|e| e.contains("E0102")));
    let said = parts["errors"].as_str().unwrap();
    assert!(said.contains("hall.lss:10:3") && said.contains("<mark>sped</mark>") && said.contains("`speed`"), "{said}");
    assert_eq!((&parts["plan"], &parts["status"]["stale"]), (&before["plan"], &json!(true)));
    assert!(parts["source"]["html"].as_str().unwrap().contains("sped 2.0"));
    // A file that is away for a while.
    fs::remove_file(&preview.file).unwrap();
    let parts =
        preview.until("no file", |parts| parts["errors"].as_str().is_some_and(|e| e.contains("cannot be read")));
    assert_eq!(parts["plan"], before["plan"]);
    preview.save(HALL);
    let parts = preview.until_solved();
    assert!(
        !parts["errors"].as_str().unwrap().contains("class=\"error") && parts["status"]["stale"] == false,
        "{parts}"
    );
    // What comes of names and texts is no markup.
    preview.save(&HALL.replace("layout hall", "layout <img/src=x>"));
    let parts = preview.until("markup", |parts| parts["errors"].as_str().is_some_and(|e| e.contains("img/src")));
    assert!(!parts["errors"].as_str().unwrap().contains("<img"), "{parts}");
    assert!(!parts["source"]["html"].as_str().unwrap().contains("<img"), "{parts}");
}

#[test]
fn imported_files_are_followed_too() {
    let preview = Preview::new(&HALL.replace("let far = 37 m", "use \"measures.lss\""));
    preview.until("the missing file", |parts| parts["errors"].as_str().is_some_and(|e| e.contains("E0202")));
    let measures = preview.folder.path().join("measures.lss");
    let x_of_p3 = |wanted: f64| move |parts: &Value| parts["plan"]["vertices"][2]["x"] == json!(wanted);
    fs::write(&measures, "let far = 37 m\n").unwrap();
    preview.until("the import", x_of_p3(37.0));
    fs::write(&measures, "let far = 36 m\n").unwrap();
    preview.until("its change", x_of_p3(36.0));
}

#[test]
fn a_movement_is_shown_to_every_page_and_written_by_none() {
    let preview = Preview::new(&optimised());
    preview.until_solved();
    assert_eq!(preview.post("move", &preview.placed(0, 4.0, 5.5)).status, 200);
    let parts = preview.until("the movement", |parts| parts["moving"]["svg"].is_string());
    assert_eq!(parts["moving"]["moved"], json!({ "vertex": 0, "x": 4.0, "y": 5.5 }));
    assert_eq!(preview.text(), optimised());
    // What cannot be built says so; the plan stays.
    assert_eq!(preview.post("move", &preview.placed(0, 37.0, 3.0)).status, 200);
    let parts = preview.until("the problem", |parts| parts["moving"]["problem"].is_string());
    assert!(parts["plan"]["svg"].is_string() && parts["moving"]["svg"].is_null());
    assert_eq!(preview.post("still", "{}").status, 200);
    preview.until("the end", |parts| parts["moving"].is_null());
}

#[test]
fn one_of_several_layouts_is_shown() {
    let both = format!("{HALL}\nlayout wide from hall {{ vertex P4 (2.5 m, 17 m) radius 3 m }}\n");
    let preview = Preview::new(&both);
    let parts = preview.until("the question", |parts| parts["errors"].as_str().is_some_and(|e| e.contains("--layout")));
    assert!(parts["errors"].as_str().unwrap().contains("`hall`, `wide`"), "{parts}");
    let preview = Preview::with(&both, &["--layout", "wide"]);
    let parts = preview.until_solved();
    assert_eq!((&parts["plan"]["name"], &parts["plan"]["vertices"][3]["x"]), (&json!("wide"), &json!(2.5)));
    // A vertex of the base stands there.
    assert_eq!(preview.post("put", &preview.placed(0, 3.5, 3.0)).status, 200);
    assert_eq!(preview.text(), both.replace("P1 (3 m, 3 m)", "P1 (3.5 m, 3 m)"));
    let preview = Preview::with(&both, &["--layout", "narrow"]);
    preview.until("no such layout", |parts| parts["errors"].as_str().is_some_and(|e| e.contains("no layout `narrow`")));
}

#[test]
fn facts_say_what_a_build_says() {
    let preview = Preview::new(&optimised());
    let parts = preview.until_solved();
    let facts = parts["facts"].as_str().unwrap();
    let run = |arguments: &[&str]| {
        let mut command = assert_cmd::Command::cargo_bin("lss").unwrap();
        let output = command.current_dir(preview.folder.path()).arg("build").arg("hall.lss").args(arguments).output();
        String::from_utf8(output.unwrap().stdout).unwrap()
    };
    let said = run(&["-o", "out"]);
    let layout = fs::read(preview.folder.path().join("out/layout.json")).unwrap();
    let layout: Value = serde_json::from_slice(&layout).unwrap();
    let length = format!("{:.3} m", layout["length_m"].as_f64().unwrap());
    let proof = said.lines().find(|line| line.contains("proven shortest")).unwrap().trim();
    assert!(facts.contains(&length) && facts.contains(proof), "{length}, {proof}\n{facts}");
    assert_eq!(
        (&parts["plan"]["length"], &parts["status"]["words"]),
        (&json!(length), &json!("proven to be the best on the catalogue's grid"),)
    );
    let bill = fs::read_to_string(preview.folder.path().join("out/bom.csv")).unwrap();
    let articles: Vec<&str> = bill.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert!(articles.len() > 1 && articles.iter().all(|article| facts.contains(article)), "{articles:?}\n{facts}");
    // What a limit costs, as `--emit freedom` has it.
    let freedom = run(&["--emit", "freedom", "-o", "free"]);
    let row = freedom.lines().find(|line| line.contains("each metre")).unwrap();
    let words = row[row.find("each").unwrap()..].split("  ").next().unwrap();
    assert!(facts.contains(words), "{words}\n{facts}");
}

#[test]
fn straights_of_a_route_lead_to_the_lines_of_their_sections() {
    let vertices = |line: &&str| !line.trim_start().starts_with("vertex") && !line.trim_start().starts_with("require");
    let bare: Vec<&str> = HALL.lines().filter(vertices).collect();
    let text = bare.join("\n").replace(
        "  optimise nothing",
        "  section docks (10 m, 3 m)..(30 m, 3 m)\n  section chutes (30 m, 17 m)..(10 m, 17 m)\n  route docks, chutes\n  \
         optimise length",
    );
    let line = |of: &str| text.lines().position(|line| line.trim_start().starts_with(of)).unwrap() + 1;
    let preview = Preview::with(&text, &["--time-limit", "5s"]);
    let parts = preview.until_solved();
    let lines = parts["plan"]["lines"].as_object().unwrap();
    let straights: Vec<&Value> = lines.iter().filter(|(key, _)| key.starts_with('s')).map(|(_, own)| own).collect();
    for of in ["section docks", "section chutes"] {
        assert!(straights.iter().any(|own| **own == json!([line(of)])), "{of}: {lines:?}");
    }
    assert!(lines.iter().filter(|(key, _)| key.starts_with('c')).all(|(_, own)| *own == json!([line("route")])));
    let facts = parts["facts"].as_str().unwrap();
    assert!(facts.contains(&format!("data-line=\"{}\"", line("section docks"))), "{facts}");
    assert!(facts.contains("line of section chutes = 17 m"), "{facts}");
}

#[cfg(unix)]
#[test]
fn an_interruption_ends_it_cleanly_even_while_a_page_waits() {
    let preview = Preview::new(HALL);
    preview.until_solved();
    let (port, path) = (preview.port, preview.path.clone());
    let waiting = std::thread::spawn(move || {
        use std::io::{Read, Write};
        let mut stream = std::net::TcpStream::connect(("127.0.0.1", port)).unwrap();
        let request = format!("GET {path}state?after=1000000 HTTP/1.0\r\nHost: 127.0.0.1:{port}\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        let _ = stream.read_to_string(&mut answer);
    });
    std::thread::sleep(std::time::Duration::from_millis(200));
    assert_eq!(preview.interrupt(), Some(0));
    waiting.join().unwrap();
}

#[test]
fn what_cannot_be_shown_is_said_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let mut command = assert_cmd::Command::cargo_bin("lss").unwrap();
        let output = command
            .current_dir(folder.path())
            .arg("preview")
            .args(arguments)
            .timeout(super::client::PATIENCE)
            .output()
            .unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, said) = run(&["nowhere.lss"]);
    assert!(code == Some(2) && said.contains("could not read nowhere.lss"), "{said}");
    fs::write(folder.path().join("hall.lss"), HALL).unwrap();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let (code, said) = run(&["hall.lss", "--port", &port]);
    assert!(code == Some(2) && said.contains("could not listen on 127.0.0.1"), "{said}");
    let (code, said) = run(&["hall.lss", "--run", "run-01.csv"]);
    assert!(code == Some(2) && said.contains("run-01.csv"), "{said}");
}

//! A browser without a window, led through its own debugging protocol.
//!
//! Source: the page "Chrome `DevTools` Protocol", domains Target, Page, Runtime, Input, Log, Emulation.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// How long a page has for anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one page.
pub(crate) struct Browser {
    process: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    session: Option<String>,
    last_id: u64,
    /// What the page complained about.
    pub(crate) complaints: Vec<String>,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// Starts the browser that `CHROMIUM` names, or `chromium`.
    pub(crate) fn start() -> Self {
        let program = std::env::var("CHROMIUM").unwrap_or_else(|_| String::from("chromium"));
        let profile = tempfile::tempdir().unwrap();
        let mut process = Command::new(&program)
            .args([
                "--headless=new",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-dev-shm-usage",
                "--no-first-run",
                // Nothing of the browser's own over the network.
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-quic",
                "--disable-sync",
            ])
            .args(["--hide-scrollbars", "--window-size=1280,1400", "--remote-debugging-port=0"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .unwrap_or_else(|error| panic!("{program}: {error}: install it, or name it in CHROMIUM"));
        let mut lines = BufReader::new(process.stderr.take().unwrap()).lines();
        let address = loop {
            let line = lines.next().expect("the browser ended").unwrap();
            if let Some(address) = line.strip_prefix("DevTools listening on ") {
                break address.to_owned();
            }
        };
        // It must not fill the pipe and stand still.
        std::thread::spawn(move || lines.for_each(drop));
        let (socket, _) = tungstenite::connect(&address).unwrap();
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(PATIENCE)).unwrap();
        }
        let complaints = Vec::new();
        let mut browser = Self { process, socket, session: None, last_id: 0, complaints, _profile: profile };
        let target = browser.ask("Target.createTarget", json!({"url": "about:blank"}));
        let attached =
            browser.ask("Target.attachToTarget", json!({"targetId": target["targetId"], "flatten": true}));
        browser.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.ask(domain, json!({}));
        }
        browser
    }

    /// Sends one command; its result.
    pub(crate) fn ask(&mut self, method: &str, params: Value) -> Value {
        self.last_id += 1;
        let mut request = json!({"id": self.last_id, "method": method, "params": params});
        if let Some(session) = &self.session {
            request["sessionId"] = json!(session);
        }
        self.socket.send(Message::text(request.to_string())).unwrap();
        loop {
            let Message::Text(text) = self.socket.read().expect("the browser does not answer") else {
                continue;
            };
            let answer: Value = serde_json::from_str(&text).unwrap();
            self.listen(&answer);
            if answer["id"] == json!(self.last_id) {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].clone();
            }
        }
    }

    fn listen(&mut self, event: &Value) {
        let params = &event["params"];
        match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => self.complaints.push(params["exceptionDetails"].to_string()),
            Some("Runtime.consoleAPICalled")
                if matches!(params["type"].as_str(), Some("error" | "warning")) =>
            {
                self.complaints.push(params["args"].to_string());
            }
            Some("Log.entryAdded")
                if matches!(params["entry"]["level"].as_str(), Some("error" | "warning")) =>
            {
                self.complaints.push(params["entry"].to_string());
            }
            _ => {}
        }
    }

    /// Goes to a page and waits until it is loaded; how long that took, as the page itself has it.
    pub(crate) fn open(&mut self, address: &str) -> Duration {
        self.ask("Page.navigate", json!({"url": address}));
        self.wait_for("location.href !== 'about:blank' && document.readyState === 'complete' && performance.timing.loadEventEnd > 0");
        // Two frames later everything is painted.
        self.painted();
        // A page that unpacks its data says when it is ready.
        self.wait_for("document.body.dataset.ready !== 'no'");
        let ms = self.eval(
            "Math.max(performance.timing.loadEventEnd - performance.timing.navigationStart, \
             Number(document.body.dataset.readyMs || 0))",
        );
        Duration::from_secs_f64(ms.as_f64().unwrap() / 1e3)
    }

    /// Seconds for which the page has kept the processor busy.
    pub(crate) fn busy(&mut self) -> f64 {
        let metrics = self.ask("Performance.getMetrics", json!({}));
        let all = metrics["metrics"].as_array().unwrap();
        all.iter().find(|one| one["name"] == json!("TaskDuration")).unwrap()["value"].as_f64().unwrap()
    }

    /// The value of an expression in the page.
    pub(crate) fn eval(&mut self, expression: &str) -> Value {
        let params = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.ask("Runtime.evaluate", params);
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// Text of an element.
    pub(crate) fn text(&mut self, selector: &str) -> String {
        let text = self.eval(&format!("document.querySelector({}).textContent", json!(selector)));
        text.as_str().unwrap_or_default().to_owned()
    }

    /// The value beside a name, of all names and values in the page.
    pub(crate) fn value(&mut self, name: &str) -> String {
        let find = format!(
            "[...document.querySelectorAll('dt')].find((dt) => dt.textContent === {}).nextSibling.textContent",
            json!(name)
        );
        self.eval(&find).as_str().unwrap_or_default().to_owned()
    }

    /// Waits until an expression is true.
    pub(crate) fn wait_for(&mut self, expression: &str) {
        let until = Instant::now() + PATIENCE;
        while self.eval(&format!("Boolean({expression})")) != json!(true) {
            if Instant::now() >= until {
                let page = self.eval("document.body.dataset.state + '\\n' + document.body.innerText");
                panic!("in vain: {expression}\nthe page shows:\n{}", page.as_str().unwrap_or_default());
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Presses and lets go of a key, as a person does.
    pub(crate) fn key(&mut self, key: &str, code: u32) {
        for kind in ["keyDown", "keyUp"] {
            let params = json!({"type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code});
            self.ask("Input.dispatchKeyEvent", params);
        }
    }

    /// Clicks into the middle of an element.
    pub(crate) fn click(&mut self, selector: &str) {
        let place = self.eval(&format!(
            "(() => {{ const box = document.querySelector({}).getBoundingClientRect(); \
             return [box.x + box.width / 2, box.y + box.height / 2]; }})()",
            json!(selector)
        ));
        for kind in ["mousePressed", "mouseReleased"] {
            let params =
                json!({"type": kind, "x": place[0], "y": place[1], "button": "left", "clickCount": 1});
            self.ask("Input.dispatchMouseEvent", params);
        }
    }

    /// The screen of a telephone or a tablet, in its pixels, with fingers instead of a mouse; of a computer
    /// without.
    pub(crate) fn screen(&mut self, width: u32, height: u32, has_touch: bool) {
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": has_touch});
        self.ask("Emulation.setDeviceMetricsOverride", metrics);
        self.ask(
            "Emulation.setTouchEmulationEnabled",
            json!({"enabled": has_touch, "maxTouchPoints": if has_touch { 5 } else { 1 }}),
        );
        self.painted();
    }

    /// Waits until everything is painted.
    pub(crate) fn painted(&mut self) {
        self.eval("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))");
    }

    /// Lays a finger on one place of the screen, moves it to another in ten steps, and lifts it.
    pub(crate) fn swipe(&mut self, from: [f64; 2], to: [f64; 2]) {
        let at = |n: f64| [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * n / 10.0);
        let mut touch = |kind: &str, at: Option<[f64; 2]>| {
            let points: Vec<Value> = at.into_iter().map(|[x, y]| json!({"x": x, "y": y})).collect();
            self.ask("Input.dispatchTouchEvent", json!({"type": kind, "touchPoints": points}));
        };
        touch("touchStart", Some(from));
        if from != to {
            (1..=10).for_each(|n| touch("touchMove", Some(at(n.into()))));
        }
        touch("touchEnd", None);
    }

    /// Turns the wheel of the mouse at a place of the screen by so many pixels.
    pub(crate) fn wheel(&mut self, at: [f64; 2], pixels: f64) {
        let params = json!({"type": "mouseWheel", "x": at[0], "y": at[1], "deltaX": 0, "deltaY": pixels});
        self.ask("Input.dispatchMouseEvent", params);
    }

    /// Left, top, right and lower end of an element on the screen, pixels.
    pub(crate) fn place(&mut self, selector: &str) -> [f64; 4] {
        let of = format!("document.querySelector({}).getBoundingClientRect()", json!(selector));
        let place = self.eval(&format!(
            "(() => {{ const box = {of}; return [box.left, box.top, box.right, box.bottom]; }})()"
        ));
        [0, 1, 2, 3].map(|n| place[n].as_f64().unwrap())
    }

    /// Light or dark.
    pub(crate) fn scheme(&mut self, name: &str) {
        let features = json!([{"name": "prefers-color-scheme", "value": name}]);
        self.ask("Emulation.setEmulatedMedia", json!({"features": features}));
        self.painted();
    }

    /// Keeps the whole page as `NAME.png`.
    pub(crate) fn screenshot(&mut self, name: &str) -> PathBuf {
        self.picture(name, true)
    }

    /// Keeps what is on the screen as `NAME.png`.
    pub(crate) fn screenshot_of_screen(&mut self, name: &str) -> PathBuf {
        self.picture(name, false)
    }

    fn picture(&mut self, name: &str, is_whole_page: bool) -> PathBuf {
        let directory = screenshots();
        std::fs::create_dir_all(&directory).unwrap();
        let file = directory.join(format!("{name}.png"));
        let params = json!({"format": "png", "captureBeyondViewport": is_whole_page});
        let data = self.ask("Page.captureScreenshot", params);
        std::fs::write(&file, from_base64(data["data"].as_str().unwrap())).unwrap();
        file
    }
}

/// `BROWSER_SCREENSHOTS`, or a folder beside what the tests build.
fn screenshots() -> PathBuf {
    std::env::var_os("BROWSER_SCREENSHOTS")
        .map_or_else(|| Path::new(env!("CARGO_TARGET_TMPDIR")).join("screenshots"), PathBuf::from)
}

fn from_base64(text: &str) -> Vec<u8> {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let sixes: Vec<u32> = text
        .bytes()
        .filter_map(|byte| LETTERS.iter().position(|&letter| letter == byte))
        .map(|place| u32::try_from(place).unwrap())
        .collect();
    let mut bytes = Vec::new();
    for four in sixes.chunks(4) {
        let word = four.iter().enumerate().fold(0, |word, (n, six)| word | six << (18 - 6 * n));
        bytes.extend(&word.to_be_bytes()[1..four.len()]);
    }
    bytes
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

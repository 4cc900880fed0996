//! Who is answered. Other users of the machine and pages of other sites reach a port on the loopback, too: a request
//! needs the token, which nobody else knows, and must have been made for this address, which no page of another site
//! can do even if its name leads to the loopback (DNS rebinding).

use tiny_http::{Method, Request};

/// What requests have to know and say.
#[derive(Clone, Debug)]
pub struct Guard {
    token: String,
    port: u16,
}

/// Why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Made for another host, or by a page of another site.
    Foreign,
    /// Without the token.
    Unknown,
}

/// A random token: 128 bits, as hexadecimal digits.
///
/// # Errors
///
/// The system has no random numbers.
pub fn token() -> Result<String, getrandom::Error> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)?;
    Ok(crate::base::digest::hex(&bytes))
}

impl Guard {
    pub fn new(token: String, port: u16) -> Guard {
        Guard { token, port }
    }

    /// The path of a request below the token: `""`, `"state"`, with what stands behind `?`.
    ///
    /// # Errors
    ///
    /// Why it is refused.
    pub fn admit(&self, request: &Request) -> Result<(String, String), Refusal> {
        let headers = |name: &'static str| {
            let own = request.headers().iter().filter(move |header| header.field.equiv(name));
            own.map(|header| header.value.as_str().to_owned()).collect::<Vec<_>>()
        };
        let asks = *request.method() == Method::Post;
        self.admits(request.url(), asks, &headers("Host"), &headers("Origin"))
    }

    fn admits(
        &self,
        url: &str,
        changes: bool,
        host: &[String],
        origin: &[String],
    ) -> Result<(String, String), Refusal> {
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        let [host] = host else { return Err(Refusal::Foreign) };
        if !hosts.contains(host) {
            return Err(Refusal::Foreign);
        }
        let own = format!("http://{host}");
        match origin {
            // Browsers say it with everything that may change something.
            [] if changes => return Err(Refusal::Foreign),
            [] => {}
            [origin] if *origin == own => {}
            _ => return Err(Refusal::Foreign),
        }
        let (path, query) = url.split_once('?').unwrap_or((url, ""));
        let path = path.strip_prefix('/').ok_or(Refusal::Unknown)?;
        let (token, rest) = path.split_once('/').ok_or(Refusal::Unknown)?;
        if !same(token, &self.token) {
            return Err(Refusal::Unknown);
        }
        Ok((rest.to_owned(), query.to_owned()))
    }
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_address_that_was_printed_is_answered() {
        let guard = Guard::new("abc".into(), 4000);
        let asked = |url: &str, changes: bool, host: &[&str], origin: &[&str]| {
            let own = |texts: &[&str]| texts.iter().map(ToString::to_string).collect::<Vec<_>>();
            guard.admits(url, changes, &own(host), &own(origin))
        };
        let (here, ours) = (&["127.0.0.1:4000"][..], &["http://127.0.0.1:4000"][..]);
        let admitted = |path: &str, query: &str| Ok((path.to_owned(), query.to_owned()));
        assert_eq!(asked("/abc/", false, here, &[]), admitted("", ""));
        assert_eq!(asked("/abc/", false, &["localhost:4000"], &[]), admitted("", ""));
        assert_eq!(asked("/abc/state?after=3", false, here, ours), admitted("state", "after=3"));
        assert_eq!(asked("/abc/put", true, here, ours), admitted("put", ""));
        for url in ["/", "/abc", "/abd/", "/abcd/", "/ab/", "abc", "/../abc/", "//abc/", "/%61bc/", "/ABC/"] {
            assert_eq!(asked(url, false, here, &[]), Err(Refusal::Unknown), "{url}");
        }
        for host in [&[][..], &["evil.example:4000"], &["127.0.0.1"], &["127.0.0.1:4001"], &["127.0.0.1:4000", "a"]] {
            assert_eq!(asked("/abc/", false, host, &[]), Err(Refusal::Foreign), "{host:?}");
        }
        for origin in [&["http://evil.example"][..], &["null"], &["https://127.0.0.1:4000"], &["http://localhost:4000"]]
        {
            assert_eq!(asked("/abc/", false, here, origin), Err(Refusal::Foreign), "{origin:?}");
        }
        assert_eq!(asked("/abc/put", true, here, &[]), Err(Refusal::Foreign), "a change without an origin");
    }

    #[test]
    fn tokens_are_long_and_differ() {
        let (a, b) = (token().unwrap(), token().unwrap());
        assert!(a.len() == 32 && a != b);
    }
}

//! Keys: read from environment variables, never printed, taken out of everything that comes back.

use std::ffi::OsString;
use std::fmt;
use std::ops::Range;

use crate::error::EndpointError;

/// Replaces a key.
pub(crate) const REDACTED: &str = "[redacted]";

/// A shorter key looks like a word when it is taken out of what a server sends.
const SHORTEST: usize = 8;

/// Encodings within encodings that are seen through.
const DEEPEST: u32 = 4;

/// The value of a digit, if it is one.
type ValueOf = fn(u8) -> Option<u8>;

/// Bits of a digit, and values of digits: base64, that of URLs too, and hex.
const PACKINGS: [(usize, ValueOf); 2] = [(6, base64_value), (4, hex_value)];

/// Escapes with a fixed number of hex digits.
const ESCAPES: [(&[u8], usize); 4] = [(b"%u", 4), (b"%", 2), (b"\\u", 4), (b"\\x", 2)];

/// What `\` and a letter or `&name;` mean.
const SHORT_ESCAPES: [(&[u8], u8); 7] =
    [(b"/", b'/'), (b"\\", b'\\'), (b"\"", b'"'), (b"'", b'\''), (b"n", b'\n'), (b"r", b'\r'), (b"t", b'\t')];
const ENTITIES: [(&[u8], u8); 18] = [
    (b"amp", b'&'),
    (b"lt", b'<'),
    (b"gt", b'>'),
    (b"quot", b'"'),
    (b"apos", b'\''),
    (b"sol", b'/'),
    (b"bsol", b'\\'),
    (b"plus", b'+'),
    (b"equals", b'='),
    (b"lowbar", b'_'),
    (b"period", b'.'),
    (b"colon", b':'),
    (b"semi", b';'),
    (b"comma", b','),
    (b"num", b'#'),
    (b"percnt", b'%'),
    (b"dollar", b'$'),
    (b"commat", b'@'),
];

/// Where keys are looked up by the name of their variable.
pub(crate) type Environment<'a> = &'a dyn Fn(&str) -> Option<OsString>;

/// A key. Its text goes into a request header and nowhere else.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Secret(String);

impl Secret {
    /// The key in a variable of the environment.
    pub(crate) fn read(variable: &str, environment: Environment<'_>) -> Result<Self, EndpointError> {
        let text = environment(variable).ok_or("is not set");
        text.and_then(|text| text.into_string().map_err(|_not_utf8| "is not text"))
            .and_then(|text| Self::new(&text))
            .map_err(|message| {
                let remedy = "export the key, or leave `api_key_env` out if the server wants none";
                EndpointError::not_asked(format!("environment variable {variable}"), message, remedy)
            })
    }

    /// Checks a key; space around it is dropped. The error never quotes it.
    fn new(text: &str) -> Result<Self, &'static str> {
        let text = text.trim();
        if text.len() < SHORTEST {
            return Err("holds fewer than 8 characters, which is no key");
        }
        if !text.bytes().all(|byte| byte.is_ascii_graphic()) {
            return Err("holds spaces, line breaks or other characters that no key has");
        }
        Ok(Self(text.to_owned()))
    }

    /// The text, for a header.
    pub(crate) fn expose(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(REDACTED)
    }
}

/// Takes keys out of text, however a server echoes them: a key is looked for in what the text says and in what that says
/// once its escapes are undone or its base64 is read, whatever the case of letters.
#[derive(Clone, Default)]
pub(crate) struct Redactor {
    /// Each key, and what is left of it where a part of it looks like an escape.
    keys: Vec<Vec<u8>>,
}

/// A byte that a text says, and the bytes of the text that say it.
#[derive(Clone, Copy)]
struct Said {
    byte: u8,
    start: u32,
    end: u32,
}

impl Redactor {
    /// For these keys.
    pub(crate) fn new(secrets: &[Secret]) -> Self {
        let mut keys = Vec::new();
        for secret in secrets {
            let mut said = Some(literally(&secret.0));
            while let Some(key) = said.filter(|key| key.len() >= SHORTEST) {
                keys.push(key.iter().map(|said| said.byte).collect());
                said = unescaped(&key);
            }
        }
        Self { keys }
    }

    /// Text without keys.
    pub(crate) fn text(&self, text: &str) -> String {
        let mut found = Vec::new();
        if !self.keys.is_empty() {
            self.search(&literally(text), DEEPEST, &mut found);
        }
        found.sort_by_key(|place| place.start);
        let (mut clean, mut end) = (String::with_capacity(text.len()), 0);
        for place in found {
            if place.start >= end {
                clean.push_str(text.get(end..place.start).unwrap_or_default());
                clean.push_str(REDACTED);
            }
            end = end.max(place.end);
        }
        clean.push_str(text.get(end..).unwrap_or_default());
        clean
    }

    /// Finds keys in what was said, and in what that says in turn.
    fn search(&self, said: &[Said], depth: u32, found: &mut Vec<Range<usize>>) {
        for key in &self.keys {
            let is_key = |window: &&[Said]| {
                window.iter().zip(key).all(|(said, key)| said.byte.eq_ignore_ascii_case(key))
            };
            let keys = said.windows(key.len()).filter(is_key);
            found.extend(keys.map(|key| key[0].start as usize..key[key.len() - 1].end as usize));
        }
        if depth == 0 {
            return;
        }
        if let Some(said) = unescaped(said) {
            self.search(&said, depth - 1, found);
        }
        for (bits, value) in PACKINGS {
            // At how many digits into a run the first byte may begin: then bits and bytes are in step again.
            for first in 0..if bits == 6 { 4 } else { 2 } {
                let said = unpacked(said, bits, value, first);
                if !said.is_empty() {
                    self.search(&said, depth / 2, found);
                }
            }
        }
    }
}

fn literally(text: &str) -> Vec<Said> {
    (0..).zip(text.bytes()).map(|(start, byte)| Said { byte, start, end: start + 1 }).collect()
}

/// The same once escapes are undone; none where there are no escapes.
fn unescaped(said: &[Said]) -> Option<Vec<Said>> {
    let mut plain = Vec::with_capacity(said.len());
    let mut rest = said;
    while let [first, after @ ..] = rest {
        let escape = if b"%\\&".contains(&first.byte) { escape(rest) } else { None };
        let (byte, length) = escape.unwrap_or((first.byte, 1));
        plain.push(Said { byte, start: first.start, end: rest[length - 1].end });
        rest = &after[length - 1..];
    }
    (plain.len() < said.len()).then_some(plain)
}

/// The ASCII character that an escape at the beginning means, and the length of the escape.
fn escape(said: &[Said]) -> Option<(u8, usize)> {
    let starts_with = |at: usize, word: &[u8]| {
        let there = said.get(at..at + word.len());
        there.is_some_and(|there| there.iter().zip(word).all(|(a, b)| a.byte.eq_ignore_ascii_case(b)))
    };
    let number = |at: usize, most: usize, radix: u32| {
        let digits = said.iter().skip(at).take(most).map_while(|said| char::from(said.byte).to_digit(radix));
        digits.fold((0, 0), |(number, length), digit| (number * radix + digit, length + 1))
    };
    let ascii = |number: u32| u8::try_from(number).ok().filter(u8::is_ascii);
    for (prefix, digits) in ESCAPES {
        if starts_with(0, prefix)
            && let (value, length) = number(prefix.len(), digits, 16)
            && length == digits
        {
            return Some((ascii(value)?, prefix.len() + digits));
        }
    }
    for (prefix, radix) in [(&b"&#x"[..], 16), (b"&#", 10)] {
        if starts_with(0, prefix)
            && let (value, digits @ 1..) = number(prefix.len(), 7, radix)
        {
            let end = prefix.len() + digits;
            return Some((ascii(value)?, end + usize::from(starts_with(end, b";"))));
        }
    }
    let (list, end): (&[_], &[u8]) = match said[0].byte {
        b'\\' => (&SHORT_ESCAPES, b""),
        b'&' => (&ENTITIES, b";"),
        _ => return None,
    };
    let named = list.iter().find(|(name, _)| starts_with(1, name) && starts_with(1 + name.len(), end))?;
    Some((named.1, 1 + named.0.len() + end.len()))
}

/// What long runs of digits hold that are so many bits each, a zero byte after each run. Line breaks do not end a run.
fn unpacked(said: &[Said], bits: usize, value: ValueOf, first: usize) -> Vec<Said> {
    let mut bytes = Vec::new();
    for run in said.split(|said| !b"\r\n".contains(&said.byte) && value(said.byte).is_none()) {
        let digits = || run.iter().filter_map(|said| Some((said, value(said.byte)?))).skip(first);
        if run.len() * bits < 8 * SHORTEST || digits().count() * bits < 8 * SHORTEST {
            continue;
        }
        let (mut held, mut held_bits, mut start) = (0_u32, 0, None);
        for (said, digit) in digits() {
            held = held << bits | u32::from(digit);
            held_bits += bits;
            let begin = *start.get_or_insert(said.start);
            if held_bits >= 8 {
                held_bits -= 8;
                bytes.push(Said { byte: (held >> held_bits) as u8, start: begin, end: said.end });
                start = (held_bits > 0).then_some(said.start);
            }
        }
        bytes.push(Said { byte: 0, start: 0, end: 0 });
    }
    bytes
}

fn base64_value(digit: u8) -> Option<u8> {
    match digit {
        b'A'..=b'Z' => Some(digit - b'A'),
        b'a'..=b'z' => Some(digit - b'a' + 26),
        b'0'..=b'9' => Some(digit - b'0' + 52),
        b'+' | b'-' => Some(62),
        b'/' | b'_' => Some(63),
        _ => None,
    }
}

fn hex_value(digit: u8) -> Option<u8> {
    char::from(digit).to_digit(16).map(|value| value as u8)
}

impl fmt::Debug for Redactor {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Redactor({} keys)", self.keys.len())
    }
}

#[cfg(test)]
mod tests {
    use base64::Engine as _;
    use base64::prelude::{BASE64_STANDARD as STANDARD, BASE64_URL_SAFE_NO_PAD as URL_SAFE_NO_PAD};

    use super::*;

    const KEY: &str = "sk-canary/7Yq+\"x%41";

    fn redactor(key: &str) -> Redactor {
        Redactor::new(&[Secret::new(key).unwrap()])
    }

    fn each(text: &str, spell: impl Fn(u8) -> String) -> String {
        text.bytes().map(spell).collect()
    }

    fn unless_plain(text: &str, spell: impl Fn(u8) -> String) -> String {
        each(text, |byte| match byte.is_ascii_alphanumeric() || b"-/".contains(&byte) {
            true => char::from(byte).to_string(),
            false => spell(byte),
        })
    }

    /// How programs write a text into another one.
    fn spellings(text: &str) -> Vec<String> {
        let json = serde_json::Value::from(text).to_string();
        let json = json.trim_matches('"');
        vec![
            text.to_owned(),
            text.to_uppercase(),
            text.to_lowercase(),
            json.to_owned(),
            json.replace('/', "\\/"),
            each(text, |byte| format!("\\u{byte:04x}")),
            each(text, |byte| format!("\\x{byte:02X}")),
            each(text, |byte| format!("%{byte:02X}")),
            each(text, |byte| format!("%{byte:02x}")),
            unless_plain(text, |byte| format!("%{byte:02X}")),
            unless_plain(text, |byte| format!("%{byte:02x}")),
            unless_plain(text, |byte| format!("%{byte:02x}")).replace('/', "%2f").to_lowercase(),
            each(text, |byte| format!("&#{byte};")),
            each(text, |byte| format!("&#{byte:04}")),
            each(text, |byte| format!("&#x{byte:x};")),
            each(text, |byte| format!("&#X{byte:02X};")),
            text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;").replace('/', "&sol;"),
        ]
    }

    #[test]
    fn every_spelling_of_a_key_is_taken_out_and_nothing_else() {
        for key in [KEY, "sk-proj-0123456789abcdef", "a&b<c>d'e/f+g=h", "deadbeef01234567"] {
            for echo in spellings(key).iter().flat_map(|spelling| spellings(spelling)) {
                let text = format!("{{\"error\": \"no <b>{echo}</b>, 100% \\u00e4\"}}");
                let clean = redactor(key).text(&text);
                assert_eq!(clean, text.replace(&echo, REDACTED), "{key}");
            }
        }
    }

    #[test]
    fn packed_keys_are_taken_out() {
        let said = format!("{{\"authorization\": \"Bearer {KEY}\", \"host\": \"here\"}}");
        for cut in 0..8 {
            let said = &said[cut..];
            let hex = each(said, |byte| format!("{byte:02x}"));
            let base64 = STANDARD.encode(said);
            let wrapped = |end: &str| {
                let lines = base64.as_bytes().chunks(20).map(|line| std::str::from_utf8(line).unwrap());
                lines.collect::<Vec<_>>().join(end)
            };
            for echo in [
                &hex,
                &hex.to_uppercase(),
                &base64,
                &URL_SAFE_NO_PAD.encode(said),
                &wrapped("\r\n"),
                &wrapped("\\n"),
                &base64.replace('=', "%3D").replace('+', "%2b"),
                &STANDARD.encode(&base64),
            ] {
                let clean = redactor(KEY).text(&format!("Basic/{echo}, "));
                assert!(clean.contains(REDACTED), "{clean}");
                // What is left says neither the key nor half of it.
                let half =
                    Redactor { keys: vec![KEY.as_bytes()[..9].to_vec(), KEY.as_bytes()[9..].to_vec()] };
                assert_eq!(half.text(&clean), clean);
            }
        }
    }

    #[test]
    fn texts_without_a_key_keep_their_bytes() {
        let text = "{ \"text\" : \"a\\nb &amp; %41 sk-canar SGVsbG8gd29ybGQhIQ==\" } \u{20ac}";
        assert_eq!(redactor(KEY).text(text), text);
        assert_eq!(Redactor::default().text(text), text);
    }

    #[test]
    fn what_is_no_key_is_refused_without_being_quoted() {
        for bad in ["", "short", "with space inside", "line\nbreak-key", "schlüssel-schlüssel"] {
            assert!(Secret::new(bad).is_err(), "{bad:?} was taken for a key");
        }
        assert_eq!(Secret::new("  sk-12345678\r\n").unwrap().expose(), "sk-12345678");
    }

    #[test]
    fn a_key_has_no_debug_output() {
        let secret = Secret::new(KEY).unwrap();
        assert!(!format!("{secret:?}{:?}", redactor(KEY)).contains("canary"));
    }
}

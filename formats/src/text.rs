//! Lines, words and numbers of text files, from bytes of any encoding.

use core::str::FromStr;

/// A text after its byte order mark, if it has one.
pub fn unmarked(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The lines of a file, ended by \n, \r\n or \r (a trailing \r is white space for [`words`]).
pub fn lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let bytes = unmarked(bytes);
    let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    bytes.split(move |&b| b == end)
}

/// The words of a line.
pub fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A decimal number.
pub fn number(word: &[u8]) -> Option<f64> {
    parsed(word)
}

/// A number of any type.
pub(crate) fn parsed<T: FromStr>(word: &[u8]) -> Option<T> {
    core::str::from_utf8(word).ok()?.parse().ok()
}

/// A word as quoted in an error message: shortened, without control characters.
pub fn quoted(word: &[u8]) -> String {
    let head = word.get(..word.len().min(40)).unwrap_or_default();
    format!("\"{}\"", head.escape_ascii())
}

/// Whether a name is one of these, which are separated by spaces. One that ends with `*` stands for all that begin like it.
pub(crate) fn is_listed(name: &[u8], names: &str) -> bool {
    names.split_ascii_whitespace().map(str::as_bytes).any(|listed| match listed.split_last() {
        Some((b'*', beginning)) => name.starts_with(beginning),
        _ => name == listed,
    })
}

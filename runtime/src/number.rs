//! Formats numbers for error messages.

/// `x` to six significant digits, in the shortest usual notation: `0.05`, `1234.5`, `1.5e-9`, `NaN`.
///
/// The float formatting of the standard library would increase the size of the WebAssembly module by a tenth.
pub fn number(x: f64) -> String {
    if x.is_nan() {
        return "NaN".into();
    }
    let sign = if x < 0.0 { "-" } else { "" };
    let x = x.abs();
    if x.is_infinite() {
        return format!("{sign}Infinity");
    }
    if x < 1e15 && x.trunc() == x {
        return format!("{sign}{}", x as u64);
    }
    // Scales to six digits before the point in at most about 320 steps of ten; the rounding errors of the steps are
    // far below the sixth digit.
    let (mut scaled, mut exponent) = (x, 5);
    while scaled >= 1e6 {
        (scaled, exponent) = (scaled / 10.0, exponent + 1);
    }
    while scaled < 1e5 {
        (scaled, exponent) = (scaled * 10.0, exponent - 1);
    }
    let mut digits = scaled.round() as u64;
    if digits >= 1_000_000 {
        // Rounding carried into a seventh digit.
        digits /= 10;
        exponent += 1;
    }
    let mut text = format!("{digits}");
    if !(-5..15).contains(&exponent) {
        text.insert(1, '.');
        return format!("{sign}{}e{exponent}", trimmed(text));
    }
    if exponent < 0 {
        let zeros = "0".repeat((-exponent - 1) as usize);
        return trimmed(format!("{sign}0.{zeros}{text}"));
    }
    let point = exponent as usize + 1;
    if point >= text.len() {
        return format!("{sign}{text}{}", "0".repeat(point - text.len()));
    }
    text.insert(point, '.');
    trimmed(format!("{sign}{text}"))
}

/// Numbers in brackets: `[0.5, 1.5]`.
pub fn numbers(values: &[f64]) -> String {
    let parts: Vec<String> = values.iter().map(|&x| number(x)).collect();
    format!("[{}]", parts.join(", "))
}

/// Removes trailing zeros and a trailing point. Avoids string slices, whose panic messages format characters.
fn trimmed(mut text: String) -> String {
    while text.ends_with('0') {
        text.pop();
    }
    if text.ends_with('.') {
        text.pop();
    }
    text
}

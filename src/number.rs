//! Numbers in messages.

/// `x` to six significant digits, as a person writes it: `0.05`, `1234.5`, `1.5e-9`, `NaN`.
///
/// The standard library's float formatting would add a tenth to the size of the WebAssembly module.
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
    // Six digits before the point, by steps of ten: at most some 320, and rounding stays far below the digits.
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
    let text = format!("{digits}");
    if !(-5..15).contains(&exponent) {
        let (first, rest) = text.split_at(1);
        return trimmed(format!("{sign}{first}.{rest}")) + &format!("e{exponent}");
    }
    if exponent < 0 {
        let zeros = "0".repeat((-exponent - 1) as usize);
        return trimmed(format!("{sign}0.{zeros}{text}"));
    }
    let point = exponent as usize + 1;
    if point >= text.len() {
        return format!("{sign}{text}{}", "0".repeat(point - text.len()));
    }
    let (whole, fraction) = text.split_at(point);
    trimmed(format!("{sign}{whole}.{fraction}"))
}

/// Numbers in brackets: `[0.5, 1.5]`.
pub fn numbers(values: &[f64]) -> String {
    let parts: Vec<String> = values.iter().map(|&x| number(x)).collect();
    format!("[{}]", parts.join(", "))
}

/// Without zeros at the end, nor the point before them.
fn trimmed(text: String) -> String {
    text.trim_end_matches('0').trim_end_matches('.').into()
}

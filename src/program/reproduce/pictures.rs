//! Several pictures in one.

/// The width and height that an SVG says it has.
fn size(svg: &str) -> (f64, f64) {
    let number = |name: &str| {
        let rest = svg.split_once(&format!(" {name}=\""))?.1;
        rest.split_once('"')?.0.parse().ok()
    };
    (
        number("width").unwrap_or(400.0),
        number("height").unwrap_or(400.0),
    )
}

/// Pictures beside each other, each with a letter: (a), (b), (c) …
pub(super) fn side_by_side(pictures: &[String]) -> String {
    let mut inside = String::new();
    let (mut left, mut height) = (0.0_f64, 0.0_f64);
    for (picture, letter) in pictures.iter().zip('a'..='z') {
        let (width, tall) = size(picture);
        // Nested pictures are put where they say they are.
        let placed = picture.replacen("<svg ", &format!("<svg x=\"{left}\" y=\"24\" "), 1);
        inside += &format!(
            "<text x=\"{}\" y=\"17\" font-family=\"sans-serif\" font-size=\"15\">({letter})</text>\n{placed}\n",
            left + 8.0
        );
        left += width + 12.0;
        height = height.max(tall + 24.0);
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{left}\" height=\"{height}\" \
         viewBox=\"0 0 {left} {height}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{inside}</svg>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_beside_each_other() {
        let one = "<svg xmlns=\"a\" width=\"100\" height=\"50\"><g/></svg>".to_owned();
        let both = side_by_side(&[one.clone(), one]);
        assert!(both.contains("x=\"112\" y=\"24\"") && both.contains("(b)"));
        assert!(both.contains("width=\"224\" height=\"74\""));
    }
}

struct Shadow {
    half_size: vec2f,
    corner_radii: vec4f,
    color: vec4f,    // premultiplied
    to_clip: mat4x4f, // from scene units
}
@group(0) @binding(0) var<uniform> shadow: Shadow;

struct Pixel {
    @builtin(position) clip: vec4f,
    @location(0) place: vec2f,
}

@vertex
fn vertex(@location(0) position: vec2f, @location(1) place: vec2f) -> Pixel {
    return Pixel(shadow.to_clip * vec4f(position, 0.0, 1.0), place);
}

@fragment
fn fragment(pixel: Pixel) -> @location(0) vec4f {
    let low = shadow.half_size + pixel.place;
    let high = shadow.half_size - pixel.place;
    let all = quarter(low) - quarter(vec2f(-high.x, low.y))
        - quarter(vec2f(low.x, -high.y)) + quarter(-high);
    let radii = shadow.corner_radii;
    let near = cut(low, radii.x) + cut(vec2f(high.x, low.y), radii.y);
    let far = cut(high, radii.z) + cut(vec2f(low.x, high.y), radii.w);
    return shadow.color * clamp(all - near - far, 0.0, 1.0);
}

const PI = 3.14159265;

// The density across a straight edge.
fn profile(distance: f32) -> f32 {
    let t = clamp(distance, -1.0, 1.0);
    return 0.5 + (t * sqrt((1.0 - t) * (1.0 + t)) + asin(t)) / PI;
}

// The density of a quarter plane, by the distances inside of its sides.
fn quarter(p: vec2f) -> f32 {
    let f = vec2f(profile(p.x), profile(p.y));
    if dot(p, p) < 1.0 {
        return (f.x + f.y) / 2.0 - 0.25 + p.x * p.y / PI;
    }
    if p.x > 0.0 && p.y > 0.0 {
        return f.x + f.y - 1.0;
    }
    return select(0.0, min(f.x, f.y), p.x > 0.0 || p.y > 0.0);
}

fn cross(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}

// The angle from a to b. Without length, as in a pixel on a corner, WGSL leaves atan2 open.
fn turn(a: vec2f, b: vec2f) -> f32 {
    let y = cross(a, b);
    let x = dot(a, b);
    return select(atan2(y, x), 0.0, y == 0.0 && x >= 0.0);
}

// Twice the area that the unit disc shares with the triangle of its centre and a line.
fn line(a: vec2f, b: vec2f) -> f32 {
    if all(a == b) {
        return 0.0;
    }
    let way = normalize(b - a);
    let away = cross(a, way);
    let half = sqrt(max(1.0 - away * away, 0.0));
    let start = dot(a, way);
    let end = dot(b, way);
    let near = clamp(-half, start, end);
    let far = clamp(half, start, end);
    let foot = a - way * start;
    // Where the disc holds an end, nothing lies before or behind it: what rounding leaves may turn anywhere.
    let before = select(turn(a, foot + way * near), 0.0, near == start);
    let behind = select(turn(foot + way * far, b), 0.0, far == end);
    return before + away * (far - near) + behind;
}

// An angle of at most a quarter turn, less its sine.
fn bulge(angle: f32) -> f32 {
    let s = angle * angle;
    let tail = 1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0));
    return angle * s / 6.0 * (1.0 - s / 20.0 * tail);
}

// As `line`, for the quarter circle about m that turns from the left side to the low one.
fn arc(m: vec2f, radius: f32) -> f32 {
    let d = length(m);
    let excess = d - radius;
    let sine = clamp((1.0 - excess * excess) / max(4.0 * d * radius, 1e-12), 0.0, 1.0);
    let w = 2.0 * asin(sqrt(sine));
    var middle = turn(vec2f(1.0, 0.0), -m) + 0.75 * PI;
    middle -= 2.0 * PI * round(middle / (2.0 * PI));
    var sum = 0.0;
    for (var part = 0; part < 5; part++) {
        let outside = part > 2;
        let first = select(middle - w, middle + w, outside);
        let length = select(2.0 * w, 2.0 * PI - 2.0 * w, outside);
        let lap = 2.0 * PI * f32(select(part - 1, part - 4, outside));
        let start = max(first + lap, -0.25 * PI);
        let end = min(first + length + lap, 0.25 * PI);
        if end <= start {
            continue;
        }
        let a = m + radius * vec2f(cos(start - 0.75 * PI), sin(start - 0.75 * PI));
        let b = m + radius * vec2f(cos(end - 0.75 * PI), sin(end - 0.75 * PI));
        if outside {
            sum += turn(a, b);
        } else {
            sum += cross(a, b) + radius * radius * bulge(end - start);
        }
    }
    return sum;
}

// The density of what a rounded corner leaves out, by the distances inside of its sides.
fn cut(p: vec2f, radius: f32) -> f32 {
    if radius == 0.0 || max(p.x, p.y) >= radius + 1.0 || min(p.x, p.y) <= -1.0 {
        return 0.0;
    }
    let corner = -p;
    let lines = line(corner + vec2f(0.0, radius), corner) + line(corner, corner + vec2f(radius, 0.0));
    return (lines - arc(corner + radius, radius)) / (2.0 * PI);
}

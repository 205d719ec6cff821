//! Triangles → one generalised triangle strip (thesis 4.4.1, after the local algorithm of Evans et al. 1996).
//!
//! A strip continues as a pure strip as far as it can, turns a corner by a degenerate triangle, and when it is stuck
//! the next one starts beside the last triangle drawn that has a neighbour left; degenerate triangles join them.
//! Triangle n of a strip s is `(s[n], s[n+1], s[n+2])`, the other way round where n is odd.

/// The strip of a list of triangles whose indices are less than `vertices`. Triangles that name a vertex twice
/// are left out.
pub fn strip(triangles: &[[u32; 3]], vertices: usize) -> Vec<u32> {
    let mut walker = Walker::new(triangles, vertices);
    while let Some(start) = walker.start() {
        walker.begin(start);
        while walker.go_on() || walker.turn() {}
    }
    walker.strip
}

/// The triangles of a strip, without degenerate ones, each starting with its first vertex in the strip's order.
#[cfg(test)]
pub fn triangles(strip: &[u32]) -> Vec<[u32; 3]> {
    let orient = |(n, t): (usize, &[u32])| if n % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
    let whole = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    strip.windows(3).enumerate().map(orient).filter(whole).collect()
}

struct Walker<'a> {
    triangles: &'a [[u32; 3]],
    /// Edges that begin at vertex v: `edges[first[v]..first[v+1]]`.
    first: Vec<u32>,
    /// Sorted, for each vertex: the vertex at the edge's end, and the corner of its triangle at the beginning.
    edges: Vec<(u32, u32)>,
    /// For the first of equal edges: how many of their triangles, from there on, are known to be done.
    passed: Vec<u32>,
    done: Vec<bool>,
    /// All triangles before this one are done.
    unseen: usize,
    /// Triangles drawn that may have a neighbour left.
    drawn: Vec<u32>,
    strip: Vec<u32>,
}

impl<'a> Walker<'a> {
    fn new(triangles: &'a [[u32; 3]], vertices: usize) -> Self {
        let mut first = vec![0_u32; vertices + 2];
        triangles.iter().flatten().for_each(|&v| first[v as usize + 2] += 1);
        (2..first.len()).for_each(|v| first[v] += first[v - 1]);
        let mut edges = vec![(0, 0); 3 * triangles.len()];
        for (corner, &v) in triangles.iter().flatten().enumerate() {
            let (t, k) = (corner / 3, corner % 3);
            let slot = &mut first[v as usize + 1];
            edges[*slot as usize] = (triangles[t][(k + 1) % 3], corner as u32);
            *slot += 1;
        }
        for v in 0..vertices {
            edges[first[v] as usize..first[v + 1] as usize].sort_unstable();
        }
        let done = triangles.iter().map(|t| t[0] == t[1] || t[1] == t[2] || t[2] == t[0]).collect();
        let strip = Vec::with_capacity(3 * triangles.len());
        let passed = vec![0; edges.len()];
        Self { triangles, first, edges, passed, done, unseen: 0, drawn: Vec::new(), strip }
    }

    /// The undrawn triangle that has the edge from `u` to `v` in this direction, and its third vertex.
    fn beside(&mut self, u: u32, v: u32) -> Option<(u32, u32)> {
        let (start, end) = (self.first[u as usize] as usize, self.first[u as usize + 1] as usize);
        let first = start + self.edges[start..end].partition_point(|edge| edge.0 < v);
        loop {
            // Triangles that are done stay done: each is passed once, however many share the edge.
            let at = first + *self.passed.get(first)? as usize;
            let &(_, corner) = self.edges[..end].get(at).filter(|edge| edge.0 == v)?;
            let (t, k) = (corner / 3, corner as usize % 3);
            if !self.done[t as usize] {
                return Some((t, self.triangles[t as usize][(k + 2) % 3]));
            }
            self.passed[first] += 1;
        }
    }

    /// The triangle to start from, turned so that the strip can continue.
    fn start(&mut self) -> Option<[u32; 3]> {
        let mut beside_drawn = None;
        while let Some(&last) = self.drawn.last()
            && beside_drawn.is_none()
        {
            let [a, b, c] = self.triangles[last as usize];
            beside_drawn = [(b, a), (c, b), (a, c)].into_iter().find_map(|(u, v)| self.beside(u, v));
            if beside_drawn.is_none() {
                self.drawn.pop();
            }
        }
        while beside_drawn.is_none() && *self.done.get(self.unseen)? {
            self.unseen += 1;
        }
        let t = beside_drawn.map_or(self.unseen as u32, |(t, _)| t);
        self.draw(t);
        let [a, b, c] = self.triangles[t as usize];
        let turns = [[a, b, c], [b, c, a], [c, a, b]];
        Some(turns.into_iter().find(|&[_, v, w]| self.beside(w, v).is_some()).unwrap_or([a, b, c]))
    }

    fn draw(&mut self, t: u32) {
        self.done[t as usize] = true;
        self.drawn.push(t);
    }

    fn begin(&mut self, [a, b, c]: [u32; 3]) {
        let Some(&last) = self.strip.last() else {
            self.strip.extend([a, b, c]);
            return;
        };
        // At an odd place a triangle counts the other way round.
        self.strip.extend([last, a]);
        let turned = if self.strip.len().is_multiple_of(2) { [a, b, c] } else { [a, c, b] };
        self.strip.extend(turned);
    }

    /// Draws the neighbour across the last edge.
    fn go_on(&mut self) -> bool {
        let n = self.strip.len();
        let (u, v) = (self.strip[n - 2], self.strip[n - 1]);
        // The next triangle starts at n − 2 and is (u, v, w), or (v, u, w) where that is odd.
        let found = if n.is_multiple_of(2) { self.beside(u, v) } else { self.beside(v, u) };
        let Some((t, w)) = found else { return false };
        self.draw(t);
        self.strip.push(w);
        true
    }

    /// Puts the last triangle's first vertex in again before its last, if the neighbour across that edge is left.
    fn turn(&mut self) -> bool {
        let n = self.strip.len();
        let [x, _, v] = [self.strip[n - 3], self.strip[n - 2], self.strip[n - 1]];
        // After the turn the next triangle starts at n − 1.
        let found = if n % 2 == 1 { self.beside(x, v) } else { self.beside(v, x) };
        if found.is_none() {
            return false;
        }
        self.strip.insert(n - 1, x);
        true
    }
}

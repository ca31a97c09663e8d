use super::*;

/// Calls a body on strings in a region of their own, each of a capacity, with bytes around that must stay. The first text
/// of a builder is its destination.
fn call(wide: bool, f: &TextFn, texts: &[(&str, u32)], params: &[i64]) -> (String, u64) {
    let bytes = if wide { 2 } else { 1 };
    let mut mem = vec![0xAA; 16];
    let mut places = Vec::new();
    for (text, capacity) in texts {
        let at = mem.len() as u32;
        let mut units: Vec<u16> = text.encode_utf16().collect();
        units.resize(*capacity as usize + 1, 0);
        for unit in units {
            mem.extend(&unit.to_le_bytes()[..bytes]);
        }
        mem.extend([0xAA; 16]);
        places.push(Text { at, capacity: *capacity });
    }
    let before = mem.clone();
    let params: Vec<u64> = params.iter().map(|p| *p as u64).collect();
    let result = (f.eval)(&mut mem, &places, &params);
    let (start, end) = (places[0].at as usize, places[0].at as usize + (places[0].capacity as usize + 1) * bytes);
    assert_eq!(mem[..start], before[..start], "{} wrote in front of its destination", f.symbol);
    assert_eq!(mem[end..], before[end..], "{} wrote behind its destination", f.symbol);
    if !f.builds {
        assert_eq!(mem, before, "{} wrote", f.symbol);
        return (String::new(), result);
    }
    let unit = |n: usize| if wide { Wide::get(&mem[start..], n) } else { Narrow::get(&mem[start..], n) };
    let units: Vec<u16> = (0..=places[0].capacity as usize).map(unit).take_while(|u| *u != 0).collect();
    assert!(units.len() <= places[0].capacity as usize, "{} left no 0 at the end", f.symbol);
    assert_eq!(units.len() as u64, result, "{} tells another length", f.symbol);
    (String::from_utf16_lossy(&units), result)
}

/// What a body builds, the same for both kinds of string.
fn built(pick: fn(&TextFns) -> &TextFn, capacity: u32, texts: &[(&str, u32)], params: &[i64]) -> String {
    let all: Vec<(&str, u32)> = [("junk!!!!!!!!!!!!"[..capacity.min(16) as usize].as_ref(), capacity)]
        .into_iter()
        .chain(texts.iter().copied())
        .collect();
    let narrow = call(false, pick(&STRING), &all, params).0;
    assert_eq!(narrow, call(true, pick(&WSTRING), &all, params).0);
    narrow
}

fn number_of(pick: fn(&TextFns) -> &TextFn, texts: &[(&str, u32)], params: &[i64]) -> i64 {
    let narrow = call(false, pick(&STRING), texts, params).1;
    assert_eq!(narrow, call(true, pick(&WSTRING), texts, params).1);
    narrow as i64
}

const ABC: (&str, u32) = ("abcdef", 6);

#[test]
fn parts() {
    let left = |l| built(|f| &f.left, 8, &[ABC], &[l]);
    assert_eq!(
        [left(0), left(3), left(6), left(7), left(i64::MAX), left(-1)],
        ["", "abc", "abcdef", "abcdef", "abcdef", ""]
    );
    let right = |l| built(|f| &f.right, 8, &[ABC], &[l]);
    assert_eq!([right(0), right(2), right(6), right(99), right(i64::MIN)], ["", "ef", "abcdef", "abcdef", ""]);
    let mid = |l, p| built(|f| &f.mid, 8, &[ABC], &[l, p]);
    assert_eq!([mid(2, 1), mid(2, 5), mid(2, 6), mid(9, 2)], ["ab", "ef", "f", "bcdef"]);
    assert_eq!([mid(2, 0), mid(2, -3), mid(2, 7), mid(0, 2), mid(-1, 2), mid(i64::MAX, i64::MAX)], [""; 6]);
}

#[test]
fn changes() {
    let insert = |p| built(|f| &f.insert, 10, &[ABC, ("XY", 2)], &[p]);
    assert_eq!([insert(0), insert(2), insert(6)], ["XYabcdef", "abXYcdef", "abcdefXY"]);
    assert_eq!([insert(7), insert(-1)], ["abcdef", "XYabcdef"]);
    let delete = |l, p| built(|f| &f.delete, 10, &[ABC], &[l, p]);
    assert_eq!([delete(2, 1), delete(2, 3), delete(2, 6), delete(99, 2)], ["cdef", "abef", "abcde", "a"]);
    assert_eq!([delete(2, 0), delete(2, -1), delete(2, 7), delete(0, 3), delete(-5, 3)], ["abcdef"; 5]);
    let replace = |l, p| built(|f| &f.replace, 10, &[ABC, ("XY", 2)], &[l, p]);
    assert_eq!(
        [replace(2, 1), replace(1, 3), replace(0, 3), replace(9, 5)],
        ["XYcdef", "abXYdef", "abXYcdef", "abcdXY"]
    );
    assert_eq!([replace(2, 0), replace(2, 7), replace(2, -2)], ["abcdef"; 3]);
    // The same in the string itself.
    for wide in [false, true] {
        let fns = TextFns::of(wide);
        for capacity in [6, 7, 9, 20] {
            for new in ["", "X", "XY", "UVWXYZ and much that cannot be there"] {
                for (l, p) in (-1..9).flat_map(|l| (-1..9).map(move |p| (l, p))) {
                    let other = call(wide, &fns.replace, &[("", capacity), ("abcdef", capacity), (new, 40)], &[l, p]);
                    let itself = call(wide, &fns.change, &[("abcdef", capacity), (new, 40)], &[l, p]);
                    assert_eq!(itself, other, "{l} {p} {new} {capacity}");
                }
            }
        }
    }
}

#[test]
fn destinations_cut() {
    assert_eq!(built(|f| &f.insert, 4, &[ABC, ("XY", 2)], &[3]), "abcX");
    assert_eq!(built(|f| &f.left, 3, &[ABC], &[6]), "abc");
    assert_eq!(built(|f| &f.replace, 1, &[ABC, ("XY", 2)], &[1, 1]), "X");
    assert_eq!(built(|f| &f.put, 8, &[("xyz", 3)], &[5]), "junk!xyz");
    assert_eq!(built(|f| &f.put, 6, &[("xyz", 3)], &[5]), "junk!x");
    assert_eq!(built(|f| &f.put, 6, &[("xyz", 3)], &[99]), "junk!!");
}

#[test]
fn lengths_positions_order() {
    let len = |text| number_of(|f| &f.len, &[text], &[]);
    assert_eq!([len(("", 3)), len(("ab", 3)), len(ABC)], [0, 2, 6]);
    let find = |b| number_of(|f| &f.find, &[ABC, (b, 9)], &[]);
    assert_eq!([find("a"), find("cd"), find("f"), find("fg"), find(""), find("abcdefg")], [1, 3, 6, 0, 0, 0]);
    // 16#6261 stands in `aab` at an odd byte of a WSTRING only.
    assert_eq!(call(true, &WSTRING.find, &[("\u{6100}\u{6261}", 4), ("\u{6161}", 1)], &[]).1, 0);
    let compare = |a, b| number_of(|f| &f.compare, &[(a, 9), (b, 9)], &[]);
    assert_eq!([compare("a", "a"), compare("", ""), compare("a", "b"), compare("b", "ab")], [0, 0, -1, 1]);
    assert_eq!([compare("a", "ab"), compare("ab", "a"), compare("A", "a"), compare("\u{e4}", "z")], [-1, 1, -1, 1]);
    assert_eq!(call(true, &WSTRING.compare, &[("\u{100}", 1), ("\u{ff}", 1)], &[]).1 as i64, 1, "by units, not bytes");
}

#[test]
fn behind_the_first_characters() {
    let find = |unit: char, n| number_of(|f| &f.find_unit, &[("ab;cd;", 8)], &[unit as i64, n]);
    assert_eq!([find('a', 0), find(';', 0), find(';', 3), find(';', 6), find('a', 1)], [1, 3, 3, 0, 0]);
    assert_eq!([find('\0', 0), find(';', 99), number_of(|f| &f.find_unit, &[("ab;", 3)], &[59, 2])], [0, 0, 1]);
    let skip = |n, l| number_of(|f| &f.skip, &[("abcdef", 8)], &[n, l]);
    assert_eq!([skip(0, 2), skip(2, 3), skip(2, 99), skip(6, 1), skip(1, -4), skip(1, i64::MAX)], [2, 5, 6, 6, 1, 6]);
    let tail = |n, l| built(|f| &f.tail, 4, &[ABC], &[n, l]);
    assert_eq!([tail(0, 3), tail(2, i64::MAX), tail(4, 9), tail(6, 1), tail(1, -1)], ["abc", "cdef", "ef", "", ""]);
}

#[test]
fn whole_numbers() {
    let mut numbers = vec![i64::MIN, i64::MAX, 0, -1];
    for digits in 0..19 {
        let power = 10i64.pow(digits);
        numbers.extend([power - 1, power, power + 1, -power, 1 - power, 3 * power / 7, -(8 * power / 9)]);
    }
    for number in numbers {
        let text = number.to_string();
        assert_eq!(built(|f| &f.whole, 30, &[], &[0, number]), text);
        for capacity in [2, 8, 9, 10] {
            let cut: String = format!("junk{text}").chars().take(capacity as usize).collect();
            assert_eq!(built(|f| &f.whole, capacity, &[], &[4.min(i64::from(capacity)), number]), cut);
        }
    }
}

/// Long texts and the last bytes of the memory are other ways through the same bodies.
#[test]
fn every_length_up_to_the_end_of_the_memory() {
    for length in 0..80usize {
        for room in [0, 1, 7, 40] {
            let source: Vec<u8> = (0..length).map(|n| b'a' + (n % 23) as u8).collect();
            // Destination, source, and what lies behind it.
            let at = length as u32 + 1;
            let mut mem = [vec![b'#'; length + 1], source.clone(), vec![0], vec![b'x'; room]].concat();
            let texts = [Text { at: 0, capacity: length as u32 }, Text { at, capacity: length as u32 }];
            assert_eq!((STRING.len.eval)(&mut mem, &texts[1..], &[]), length as u64);
            assert_eq!((STRING.put.eval)(&mut mem, &texts, &[0]), length as u64);
            assert_eq!((&mem[..length], mem[length]), (source.as_slice(), 0));
            assert_eq!((STRING.compare.eval)(&mut mem, &texts, &[]), 0);
            assert_eq!((STRING.find_unit.eval)(&mut mem, &texts[1..], &[u64::from(b'#'), 0]), 0);
            for changed in 0..length {
                mem[changed] = b'#';
                assert_eq!((STRING.compare.eval)(&mut mem, &texts, &[]) as i64, -1);
                assert_eq!((STRING.find_unit.eval)(&mut mem, &texts[..1], &[u64::from(b'#'), 0]), changed as u64 + 1);
                mem[changed] = source[changed];
            }
            // A part of it over itself.
            for from in 0..=length {
                let (before, mut mem) = (&mem[at as usize..], mem.clone());
                (STRING.delete.eval)(&mut mem, &[texts[0], texts[0]], &[from as u64, 1]);
                assert_eq!(mem[..length - from], source[from..]);
                assert_eq!((mem[length - from], &mem[length + 1..]), (0, before));
            }
        }
    }
}

#[test]
fn a_long_string_is_told_up_to_the_greatest_int() {
    let mut mem = vec![b'a'; 40_001];
    mem[40_000] = 0;
    let text = Text { at: 0, capacity: 40_000 };
    assert_eq!((STRING.len.eval)(&mut mem, &[text], &[]), 32767);
    mem[39_999] = b'b';
    let at = mem.len() as u32;
    mem.extend(b"b\0");
    assert_eq!((STRING.find.eval)(&mut mem, &[text, Text { at, capacity: 1 }], &[]), 32767);
}

#[test]
fn values_to_text_and_back() {
    let text = |elem: Elem, raw: u64| {
        let params = [0, raw as i64, i64::from(elem.code())];
        built(|f| &f.write, 40, &[], &params)
    };
    assert_eq!(text(Elem::Int, 0xFFFB), "-5");
    assert_eq!(text(Elem::Bool, 1), "TRUE");
    assert_eq!(text(Elem::Byte, 255), "255");
    assert_eq!(text(Elem::Real, u64::from(0.1f32.to_bits())), "0.1");
    assert_eq!(text(Elem::Lreal, 1.5f64.to_bits()), "1.5");
    assert_eq!(text(Elem::Time, 1_500_000_000), "T#1s500ms");
    assert_eq!(text(Elem::Char, u64::from(b'x')), "x");
    assert_eq!(text(Elem::Char, 0), "");
    assert_eq!(built(|f| &f.write, 3, &[], &[0, 12345, i64::from(Elem::Dint.code())]), "123");
    assert_eq!(built(|f| &f.write, 9, &[], &[4, -77, i64::from(Elem::Dint.code())]), "junk-77");
    assert_eq!(built(|f| &f.write, 6, &[], &[9, 77, i64::from(Elem::Dint.code())]), "junk!!");
    let wchar = i64::from(Elem::Wchar.code());
    assert_eq!(call(true, &WSTRING.write, &[("", 1)], &[0, 0xD83D, wchar]).1, 1, "half a pair is a unit too");
    assert_eq!(call(false, &STRING.write, &[("", 1)], &[0, 0x20AC, wchar]).0, "?");
    let read = |elem: Elem, t: &str| number_of(|f| &f.read, &[(t, 40)], &[i64::from(elem.code())]) as u64;
    assert_eq!(read(Elem::Int, " -5x"), 0xFFFB);
    assert_eq!(read(Elem::Lreal, "2.5e-1"), 0.25f64.to_bits());
    assert_eq!(read(Elem::Time, "T#1s500ms"), 1_500_000_000);
    assert_eq!(read(Elem::Char, "xy"), u64::from(b'x'));
    assert_eq!(read(Elem::Char, ""), 0);
    assert_eq!(call(true, &WSTRING.read, &[("7\u{20ac}1", 4)], &[i64::from(Elem::Int.code())]).1, 7);
}

#[test]
fn between_the_two_kinds() {
    let mut mem = vec![0; 64];
    mem[..4].copy_from_slice(b"a\xE4z\0");
    let (narrow, wide) = (Text { at: 0, capacity: 3 }, Text { at: 8, capacity: 5 });
    assert_eq!((WSTRING.recode.eval)(&mut mem, &[wide, narrow], &[]), 3);
    assert_eq!(mem[8..16], [b'a', 0, 0xE4, 0, b'z', 0, 0, 0]);
    mem[10..12].copy_from_slice(&0x20ACu16.to_le_bytes());
    assert_eq!((STRING.recode.eval)(&mut mem, &[Text { at: 0, capacity: 2 }, wide], &[]), 2);
    assert_eq!(mem[..3], *b"a?\0");
}

/// Whatever offsets, capacities and bytes come, a body stays inside the region and changes nothing but its destination.
#[test]
fn nothing_leaves_the_region() {
    let mut seed = 0x1234_5678_9ABC_DEF1u64;
    let mut random = move |n: u64| {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        seed % n
    };
    for _ in 0..40_000 {
        let set = TextFns::of(random(2) == 1);
        let f = set.all()[random(set.all().len() as u64) as usize];
        let mut mem: Vec<u8> = (0..random(64)).map(|_| b"\0\0ab1.-"[random(7) as usize]).collect();
        let before = mem.clone();
        let texts: Vec<Text> =
            (0..f.texts).map(|_| Text { at: random(80) as u32, capacity: random(40) as u32 }).collect();
        let params: Vec<u64> =
            (0..f.params).map(|_| [0, 1, 5, u64::MAX, 1 << 63, 20, random(25)][random(7) as usize]).collect();
        (f.eval)(&mut mem, &texts, &params);
        let end = u64::from(texts[0].at) + (u64::from(texts[0].capacity) + 1) * 2;
        for (n, (a, b)) in before.iter().zip(&mem).enumerate() {
            let inside = f.builds && (u64::from(texts[0].at)..end).contains(&(n as u64));
            assert!(a == b || inside, "{} changed byte {n}", f.symbol);
        }
    }
}

#[test]
fn native_and_evaluated_are_one() {
    let mut mem = *b"hello\0\0\0";
    let text = Text { at: 0, capacity: 5 }.pack();
    assert_eq!(Text::unpack(text), Text { at: 0, capacity: 5 });
    // SAFETY: the region is `mem`, whole.
    assert_eq!(unsafe { c::plcc_string_len(mem.as_mut_ptr(), 8, text) }, 5);
    for f in STRING.all().into_iter().chain(WSTRING.all()) {
        assert!(!(f.address)().is_null());
        assert!(find_symbol(f.symbol).is_some_and(|g| std::ptr::eq(f, g)));
        // A caller's mistake gives a number, not a panic.
        (f.eval)(&mut [], &[], &[]);
    }
}

/// Every operation beside one on lists of characters, on random texts of few different characters; those that give a part of
/// a string also over that string itself.
#[test]
fn random_texts_agree_with_lists() {
    let mut state = 1u32;
    let mut next = |below: usize| {
        state = state.wrapping_mul(1_103_515_245).wrapping_add(12345);
        (state >> 16) as usize % below
    };
    type Pick = fn(&TextFns) -> &TextFn;
    type Model = fn(&[char], &[char], usize, usize) -> Vec<char>;
    fn cut(a: &[char], l: usize, p: usize) -> Option<(usize, usize)> {
        (p >= 1 && p <= a.len()).then(|| (p - 1, (p - 1 + l).min(a.len())))
    }
    let models: [(Pick, usize, Model); 6] = [
        (|f| &f.left, 1, |a, _, l, _| a[..l.min(a.len())].to_vec()),
        (|f| &f.right, 1, |a, _, l, _| a[a.len() - l.min(a.len())..].to_vec()),
        (|f| &f.mid, 1, |a, _, l, p| cut(a, l, p).map_or(vec![], |(s, e)| a[s..e].to_vec())),
        (|f| &f.delete, 1, |a, _, l, p| cut(a, l, p).map_or(a.to_vec(), |(s, e)| [&a[..s], &a[e..]].concat())),
        (|f| &f.replace, 2, |a, b, l, p| cut(a, l, p).map_or(a.to_vec(), |(s, e)| [&a[..s], b, &a[e..]].concat())),
        (|f| &f.insert, 2, |a, b, p, _| if p > a.len() { a.to_vec() } else { [&a[..p], b, &a[p..]].concat() }),
    ];
    for round in 0..4000 {
        let mut text = |most: usize| -> String { (0..next(most + 1)).map(|_| ['a', 'b', '\u{e4}'][next(3)]).collect() };
        let (a, b) = (text(if round % 4 == 0 { 40 } else { 12 }), text(5));
        let (chars, other): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
        let (a_capacity, b_capacity) = ((chars.len() + next(4)) as u32, (other.len() + next(12)) as u32);
        let (l, p, capacity) = (next(14), next(14), next(50) as u32);
        for (pick, texts, model) in models {
            let expected = model(&chars, &other, l, p);
            let params = [l as i64, p as i64];
            let all = [(a.as_str(), a_capacity), (b.as_str(), b_capacity)];
            for wide in [false, true] {
                let f = pick(TextFns::of(wide));
                let mut places = vec![("", capacity)];
                places.extend(&all[..texts]);
                let cut: String = expected.iter().take(capacity as usize).collect();
                assert_eq!(call(wide, f, &places, &params[..f.params]).0, cut, "{} of {all:?}, {params:?}", f.symbol);
                if texts == 1 {
                    let over: String = expected.iter().collect();
                    assert_eq!(over_itself(wide, f, &a, a_capacity, &params[..f.params]), over, "{} {a}", f.symbol);
                }
            }
        }
        let find = chars.windows(other.len().max(1)).position(|w| w == other).map_or(0, |at| at + 1);
        let pair = [(a.as_str(), a_capacity), (b.as_str(), b_capacity)];
        assert_eq!(number_of(|f| &f.find, &pair, &[]), find as i64, "{pair:?}");
        assert_eq!(number_of(|f| &f.compare, &pair, &[]), chars.cmp(&other) as i64, "{pair:?}");
        assert_eq!(number_of(|f| &f.compare, &[pair[0], pair[0]], &[]), 0, "{pair:?}");
        let joined: Vec<char> = "junk".chars().take(capacity as usize).chain(chars).take(capacity as usize).collect();
        assert_eq!(built(|f| &f.put, capacity, &[pair[0]], &[4]), joined.iter().collect::<String>(), "{pair:?}");
    }
}

/// The string in a memory that ends with it, built over itself.
fn over_itself(wide: bool, f: &TextFn, text: &str, capacity: u32, params: &[i64]) -> String {
    let bytes = if wide { 2 } else { 1 };
    let mut units: Vec<u16> = text.encode_utf16().collect();
    units.resize(capacity as usize + 1, 0);
    let mut mem: Vec<u8> = units.iter().flat_map(|u| u.to_le_bytes()[..bytes].to_vec()).collect();
    let place = Text { at: 0, capacity };
    let params: Vec<u64> = params.iter().map(|p| *p as u64).collect();
    let length = (f.eval)(&mut mem, &[place, place], &params) as usize;
    let unit = |n: usize| if wide { Wide::get(&mem, n) } else { Narrow::get(&mem, n) };
    let units: Vec<u16> = (0..=capacity as usize).map(unit).take_while(|u| *u != 0).collect();
    assert_eq!(units.len(), length, "{}", f.symbol);
    String::from_utf16_lossy(&units)
}

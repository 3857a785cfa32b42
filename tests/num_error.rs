use microlux::num::*;
#[test]
fn quick() {
    let mut worst = (0f64, 0f64, 0f64, 0f64);
    let mut x = 1u32;
    let mut s = 12345u32;
    for i in 0..2_000_000u32 {
        s = s.wrapping_mul(747796405).wrapping_add(2891336453);
        x = (s ^ (s >> 13)) >> (i % 31);
        if x == 0 {
            continue;
        }
        let r = recip(x);
        let v = r.mantissa as f64 * 2f64.powi(-(r.shift as i32));
        worst.0 = worst.0.max((v * x as f64 - 1.).abs());
        let (m, h) = rsqrt(x);
        let v = m as f64 * 2f64.powi(h as i32 - 47);
        worst.1 = worst.1.max((v * (x as f64).sqrt() - 1.).abs());
        let q = isqrt(x) as u64;
        assert!(q * q <= x as u64 && (q + 1) * (q + 1) > x as u64, "{x} {q}");
        let (sn, cs) = sin_cos(Turn::from_bits(s));
        let a = s as f64 / 4294967296. * core::f64::consts::TAU;
        worst.2 = worst
            .2
            .max((sn as f64 / 65536. - a.sin()).abs())
            .max((cs as f64 / 65536. - a.cos()).abs());
        let (a, b) = (s as i32, s.rotate_left(9).wrapping_mul(77) as i32);
        assert_eq!(narrow::mul_q16(a, b), mul_q16(a, b));
        for sh in 0..64 {
            assert_eq!(narrow::mul_shift(a, b, sh), ((a as i64 * b as i64) >> sh) as i32);
        }
        assert_eq!(narrow::mul_hi(a as u32, b as u32), mul_hi(a as u32, b as u32));
        let w = Wide::new(x, -7);
        let u = Wide::new(s | 1, 3);
        let f = |w: Wide| w.mantissa() as f64 * 2f64.powi(w.exponent() as i32 - 15);
        for (g, e) in [
            (w * u, f(w) * f(u)),
            (w + u, f(w) + f(u)),
            (w / u, f(w) / f(u)),
            (w.recip(), 1. / f(w)),
            (w.sqrt(), f(w).sqrt()),
            (u.sqrt(), f(u).sqrt()),
        ] {
            worst.3 = worst.3.max((f(g) / e - 1.).abs());
        }
    }
    println!("{worst:?}");
    let _ = x;
    for x in [0u32, 1, 2, 3, 4, 65535, 65536, u32::MAX, 0xfffe0001, 0xfffe0000] {
        let q = isqrt(x) as u64;
        assert!(q * q <= x as u64 && (q + 1) * (q + 1) > x as u64);
    }
}
#[test]
fn geom() {
    use microlux::geom::*;
    let mut s = 1u32;
    let mut w = (0f64, 0f64, 0f64, 0f64);
    for i in 0..500000u32 {
        let mut r = || {
            s = s.wrapping_mul(747796405).wrapping_add(2891336453);
            (s ^ (s >> 15)) as i32
        };
        let v = [r() >> (i % 29 + 1), r() >> (i % 29 + 1), r() >> (i % 29 + 1)];
        let Some((d, n)) = Offset(v).normalize() else {
            continue;
        };
        let f = v.map(|c| c as f64);
        let l = f.iter().map(|c| c * c).sum::<f64>().sqrt();
        for k in 0..3 {
            {
                let dl = (0..3).map(|j| (d.0[j] as f64).powi(2)).sum::<f64>().sqrt();
                w.0 = w.0.max((d.0[k] as f64 / dl - f[k] / l).abs());
                w.1 = w.1.max((dl / 65536. - 1.).abs());
            };
        }
        w.1 = w.1.max(((n.length() as f64 - l).abs() - 1.).max(0.) / l);
        let q = n.square();
        w.2 =
            w.2.max((q.mantissa() as f64 * 2f64.powi(q.exponent() as i32 - 15) / l / l - 1.).abs());
        let fr = Frame::about(d);
        let g = |a: Dir, b: Dir| (0..3).map(|i| a.0[i] as f64 * b.0[i] as f64).sum::<f64>() / 65536. / 65536.;
        for (a, b, e) in [
            (fr.s, fr.s, 1.),
            (fr.t, fr.t, 1.),
            (fr.n, fr.n, 1.),
            (fr.s, fr.t, 0.),
            (fr.s, fr.n, 0.),
            (fr.t, fr.n, 0.),
        ] {
            w.3 = w.3.max((g(a, b) - e).abs());
        }
    }
    println!("geom {w:?}");
}

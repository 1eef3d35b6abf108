//! Vectors of two to four numbers, plain or in lanes.

use crate::*;

/// Sums of products, in the order of the library that the plain kernels use.
pub trait Dot: Copy {
    type Number;
    fn dot(self, other: Self) -> Self::Number;
}

/// Vectors that are stretched by a number.
pub trait Scale<T>: Copy {
    fn scaled(self, by: T) -> Self;
}

/// Vectors that have one unit length afterwards; of length zero they are not numbers.
pub trait Normalize: Copy {
    fn normalized(self) -> Self;
}

macro_rules! vector {
    ($name:ident: $($field:ident)*) => {
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(C)]
        pub struct $name<T> {
            $(pub $field: T,)*
        }
        impl<T: Arithmetic> Arithmetic for $name<T> {
            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                $name { $($field: self.$field.plus(other.$field)),* }
            }
            #[inline(always)]
            fn minus(self, other: Self) -> Self {
                $name { $($field: self.$field.minus(other.$field)),* }
            }
            #[inline(always)]
            fn times(self, other: Self) -> Self {
                $name { $($field: self.$field.times(other.$field)),* }
            }
            #[inline(always)]
            fn over(self, other: Self) -> Self {
                $name { $($field: self.$field.over(other.$field)),* }
            }
            #[inline(always)]
            fn remainder(self, other: Self) -> Self {
                $name { $($field: self.$field.remainder(other.$field)),* }
            }
        }
        impl<T: Arithmetic> Scale<T> for $name<T> {
            #[inline(always)]
            fn scaled(self, by: T) -> Self {
                $name { $($field: self.$field.times(by)),* }
            }
        }
        impl<T: Negate> Negate for $name<T> {
            #[inline(always)]
            fn negated(self) -> Self {
                $name { $($field: self.$field.negated()),* }
            }
        }
        impl<T: Bits> Bits for $name<T> {
            #[inline(always)]
            fn both(self, other: Self) -> Self {
                $name { $($field: self.$field.both(other.$field)),* }
            }
            #[inline(always)]
            fn either(self, other: Self) -> Self {
                $name { $($field: self.$field.either(other.$field)),* }
            }
            #[inline(always)]
            fn one_of(self, other: Self) -> Self {
                $name { $($field: self.$field.one_of(other.$field)),* }
            }
            #[inline(always)]
            fn inverted(self) -> Self {
                $name { $($field: self.$field.inverted()),* }
            }
        }
        impl<P: Copy, T: Shift<P>> Shift<$name<P>> for $name<T> {
            #[inline(always)]
            fn upwards(self, places: $name<P>) -> Self {
                $name { $($field: self.$field.upwards(places.$field)),* }
            }
            #[inline(always)]
            fn downwards(self, places: $name<P>) -> Self {
                $name { $($field: self.$field.downwards(places.$field)),* }
            }
        }
        impl<T: Compare> Compare for $name<T> {
            type Truth = $name<T::Truth>;
            #[inline(always)]
            fn is_equal(self, other: Self) -> Self::Truth {
                $name { $($field: self.$field.is_equal(other.$field)),* }
            }
            #[inline(always)]
            fn is_unequal(self, other: Self) -> Self::Truth {
                $name { $($field: self.$field.is_unequal(other.$field)),* }
            }
            #[inline(always)]
            fn is_less(self, other: Self) -> Self::Truth {
                $name { $($field: self.$field.is_less(other.$field)),* }
            }
            #[inline(always)]
            fn is_at_most(self, other: Self) -> Self::Truth {
                $name { $($field: self.$field.is_at_most(other.$field)),* }
            }
        }
        impl<T: Extremes> Extremes for $name<T> {
            #[inline(always)]
            fn lesser(self, other: Self) -> Self {
                $name { $($field: self.$field.lesser(other.$field)),* }
            }
            #[inline(always)]
            fn greater(self, other: Self) -> Self {
                $name { $($field: self.$field.greater(other.$field)),* }
            }
        }
        impl<T: Round> Round for $name<T> {
            #[inline(always)]
            fn magnitude(self) -> Self {
                $name { $($field: self.$field.magnitude()),* }
            }
            #[inline(always)]
            fn floored(self) -> Self {
                $name { $($field: self.$field.floored()),* }
            }
            #[inline(always)]
            fn ceiled(self) -> Self {
                $name { $($field: self.$field.ceiled()),* }
            }
            #[inline(always)]
            fn truncated(self) -> Self {
                $name { $($field: self.$field.truncated()),* }
            }
            #[inline(always)]
            fn root(self) -> Self {
                $name { $($field: self.$field.root()),* }
            }
        }
        impl<M: Copy, T: Transcendental<M>> Transcendental<M> for $name<T> {
            #[inline(always)]
            fn each(self, mask: M, function: impl Fn(f32) -> f32) -> Self {
                $name { $($field: self.$field.each(mask, &function)),* }
            }
            #[inline(always)]
            fn each_of_two(self, mask: M, other: Self, function: impl Fn(f32, f32) -> f32) -> Self {
                $name { $($field: self.$field.each_of_two(mask, other.$field, &function)),* }
            }
        }
        impl<T: Blend> Blend for $name<T> {
            type Mask = T::Mask;
            #[inline(always)]
            fn blend(mask: T::Mask, set: Self, clear: Self) -> Self {
                $name { $($field: T::blend(mask, set.$field, clear.$field)),* }
            }
        }
        impl<T: Zero> Zero for $name<T> {
            #[inline(always)]
            fn zero() -> Self {
                $name { $($field: T::zero()),* }
            }
        }
        impl<F, T: Convert<F>> Convert<$name<F>> for $name<T> {
            #[inline(always)]
            fn convert(self) -> $name<F> {
                $name { $($field: self.$field.convert()),* }
            }
        }
        impl<F, T: Reinterpret<F>> Reinterpret<$name<F>> for $name<T> {
            #[inline(always)]
            fn reinterpret(self) -> $name<F> {
                $name { $($field: self.$field.reinterpret()),* }
            }
        }
        impl<T> Normalize for $name<T>
        where
            T: Arithmetic + Round + Reciprocal,
            $name<T>: Dot<Number = T>,
        {
            #[inline(always)]
            fn normalized(self) -> Self {
                self.scaled(self.dot(self).root().reciprocal())
            }
        }
    };
}

/// Numbers with `1 / x`.
pub trait Reciprocal: Copy {
    fn reciprocal(self) -> Self;
}

impl Reciprocal for f32 {
    #[inline(always)]
    fn reciprocal(self) -> Self {
        1.0 / self
    }
}

vector!(V2: x y);
vector!(V3: x y z);
vector!(V4: x y z w);

impl<T: Arithmetic> Dot for V2<T> {
    type Number = T;
    #[inline(always)]
    fn dot(self, other: Self) -> T {
        self.x.times(other.x).plus(self.y.times(other.y))
    }
}

impl<T: Arithmetic> Dot for V3<T> {
    type Number = T;
    #[inline(always)]
    fn dot(self, other: Self) -> T {
        self.x.times(other.x).plus(self.y.times(other.y)).plus(self.z.times(other.z))
    }
}

impl<T: Arithmetic> Dot for V4<T> {
    type Number = T;
    #[inline(always)]
    fn dot(self, other: Self) -> T {
        // The order of the library's vector unit.
        let even = self.x.times(other.x).plus(self.z.times(other.z));
        even.plus(self.y.times(other.y).plus(self.w.times(other.w)))
    }
}

#[inline(always)]
pub fn dot<V: Dot>(a: V, b: V) -> V::Number {
    a.dot(b)
}

/// A vector times a number.
#[inline(always)]
pub fn scale<V: Scale<T>, T>(vector: V, by: T) -> V {
    vector.scaled(by)
}

#[inline(always)]
pub fn normalize<V: Normalize>(vector: V) -> V {
    vector.normalized()
}

#[inline(always)]
pub fn cross<T: Arithmetic>(a: V3<T>, b: V3<T>) -> V3<T> {
    let part = |p: T, q: T, r: T, s: T| p.times(q).minus(r.times(s));
    V3 { x: part(a.y, b.z, b.y, a.z), y: part(a.z, b.x, b.z, a.x), z: part(a.x, b.y, b.x, a.y) }
}

/// `incident - 2 (normal . incident) normal`.
#[inline(always)]
pub fn reflect<V: Dot<Number = T> + Scale<T> + Arithmetic, T: Arithmetic>(incident: V, normal: V) -> V {
    let along = normal.dot(incident);
    incident.minus(normal.scaled(along.plus(along)))
}

//! Values that are the same for all rays, given to each. Every kind of lanes has its own trait: a plain number has one
//! form in each of them.

/// Defines the trait `Widen`, what has it in all kinds of lanes, and its opposite.
macro_rules! widen {
    () => {
        /// A value that is the same for all rays, to be given to each.
        pub trait Widen: Copy {
            type Lanes;
            fn widen(self) -> Self::Lanes;
        }

        #[inline(always)]
        pub fn widen<T: Widen>(value: T) -> T::Lanes {
            value.widen()
        }

        impl<T: Widen, const N: usize> Widen for [T; N] {
            type Lanes = [T::Lanes; N];
            #[inline(always)]
            fn widen(self) -> Self::Lanes {
                self.map(T::widen)
            }
        }

        impl<T: Widen> Widen for V2<T> {
            type Lanes = V2<T::Lanes>;
            #[inline(always)]
            fn widen(self) -> Self::Lanes {
                V2 { x: self.x.widen(), y: self.y.widen() }
            }
        }

        impl<T: Widen> Widen for V3<T> {
            type Lanes = V3<T::Lanes>;
            #[inline(always)]
            fn widen(self) -> Self::Lanes {
                V3 { x: self.x.widen(), y: self.y.widen(), z: self.z.widen() }
            }
        }

        impl<T: Widen> Widen for V4<T> {
            type Lanes = V4<T::Lanes>;
            #[inline(always)]
            fn widen(self) -> Self::Lanes {
                V4 { x: self.x.widen(), y: self.y.widen(), z: self.z.widen(), w: self.w.widen() }
            }
        }

        /// The value of the rays that are live, if it is the same for all of them.
        #[inline(always)]
        pub fn together(live: Mask, values: U32) -> Option<u32> {
            let one = values.to_array()[live.bits().trailing_zeros() as usize % LANES];
            live.without(crate::equal(values, widen(one))).none().then_some(one)
        }

        impl Widen for bool {
            type Lanes = Mask;
            #[inline(always)]
            fn widen(self) -> Mask {
                if self { Mask::ALL } else { Mask::NONE }
            }
        }
    };
}

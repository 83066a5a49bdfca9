//! What a page or a script calls: every item by its number.

use crate::ITEMS;

/// How many items there are.
#[unsafe(no_mangle)]
extern "C" fn items() -> u32 {
    ITEMS.len() as u32
}

/// The hash of an item.
#[unsafe(no_mangle)]
extern "C" fn hash(item: u32, queries: u32) -> u64 {
    ITEMS.get(item as usize).map_or(0, |item| (item.hash)(queries))
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    core::arch::wasm32::unreachable()
}

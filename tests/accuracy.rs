//! The alternatives of accuracy: each loses what it is said to lose, and nothing else.

use ocellus_kernel::Real;

use crate::support::in_both_precisions;
use crate::support::losses::rows;

in_both_precisions!(alternatives_lose_what_they_are_said_to_lose);

fn alternatives_lose_what_they_are_said_to_lose<R: Real>() {
    for row in rows::<R>() {
        let loss = (row.measure)(30_000);
        let what = format!("{}, {}: {loss:?}, limit {:?}", row.option, row.class, row.limit);
        println!("{what}");
        assert!(loss.trials >= 2000, "{what}");
        assert_eq!(row.is_kept(&loss), row.keeps, "{what}");
    }
}

import { Link } from "@tanstack/react-router";
import { Empty } from "../components/Empty";
import { PageHead } from "../components/PageHead";

export function NotFoundPage() {
  return (
    <>
      <PageHead title="No such page" />
      <Empty title="This address leads nowhere">
        It may have been mistyped.{" "}
        <Link to="/" className="link">
          Go to the start
        </Link>
        .
      </Empty>
    </>
  );
}

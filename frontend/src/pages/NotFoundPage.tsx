import { Link } from "@tanstack/react-router";
import { Empty } from "../components/display/Empty";
import { PageHead } from "../components/frame/PageHead";

export function NotFoundPage() {
  return (
    <>
      <PageHead title="No such page" />
      <Empty title="No page at this address">
        It may have been mistyped.{" "}
        <Link to="/" className="link">
          Open the start page
        </Link>
        .
      </Empty>
    </>
  );
}

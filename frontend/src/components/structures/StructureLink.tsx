import { Link } from "@tanstack/react-router";

/** To one version of a model structure. */
export function StructureLink(props: { name: string; id: number; version: number }) {
  return (
    <Link
      to="/model-structures/$id"
      params={{ id: props.id }}
      search={{ version: props.version }}
      className="link"
    >
      {props.name}, version {props.version}
    </Link>
  );
}

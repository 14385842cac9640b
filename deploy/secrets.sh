#!/bin/sh
# Makes the secrets that docker-compose.yml names, in the folder secrets/ (or the one that is given), where it is not
# there yet. Only its owner can enter the folder; the files in it can be read by the users of the containers.
set -eu
folder=${1:-secrets}
if [ -e "$folder" ]; then
    echo "secrets.sh: $folder is there already and stays as it is" >&2
    exit 0
fi
umask 022
new=$folder.new
rm -rf "$new"
mkdir -m 700 "$new"

random() {
    openssl rand -hex 32
}
put() {
    printf '%s\n' "$2" > "$new/$1"
}
s3_pair() {
    printf '[default]\naws_access_key_id = %s\naws_secret_access_key = %s\n' "$1" "$2" > "$new/s3_$1"
}

owner=$(random) service=$(random) admin_key=$(random) service_key=$(random)
put TREESTROKE_SECRET "$(random)"
put TREESTROKE_OWNER_DATABASE_URL "postgresql://treestroke_owner:$owner@postgres:5432/treestroke"
put TREESTROKE_DATABASE_URL "postgresql://treestroke:$service@postgres:5432/treestroke"
put postgres_password "$(random)"
put owner_password "$owner"
put service_password "$service"
s3_pair admin "$admin_key"
s3_pair service "$service_key"
put s3_keys "{\"identities\": [
  {\"name\": \"admin\", \"credentials\": [{\"accessKey\": \"admin\", \"secretKey\": \"$admin_key\"}],
   \"actions\": [\"Admin\"]},
  {\"name\": \"service\", \"credentials\": [{\"accessKey\": \"service\", \"secretKey\": \"$service_key\"}],
   \"actions\": [\"Read:treestroke\", \"Write:treestroke\", \"List:treestroke\"]}]}"
mv "$new" "$folder"
